#include "render/scene_renderer.h"

#include <algorithm>
#include <cmath>

#include "model/errors.h"
#include "render/shaders.h"

namespace grouser {
namespace {

constexpr int k_shadow_size = 2048;
constexpr int k_samples = 4;  ///< llvmpipe offers 1 or 4

/// The uniform block of shaders/frame.glsl (std140).
struct FrameBlock {
  Matrix4f view_projection, from_clip, light_projection;
  Eigen::Vector4f eye, view_direction, sun, footprint, footprint_size;
};

/// struct Instance of shaders/instance.glsl (std430). Unaligned: Eigen's own alignment would stretch it.
struct InstanceBlock {
  std::array<float, 16> X_WB;
  std::array<float, 4> tint, look;
};

void require_size(int width, int height) {
  const auto good = [](int n) { return n >= 16 && n <= 8192 && n % 2 == 0; };
  if (good(width) && good(height)) return;
  throw InputError(
      {"", "picture size", "even numbers from 16 to 8192", std::to_string(width) + " x " + std::to_string(height), ""});
}

constexpr float k_ghost = 0.3f;    ///< share that is drawn of a see-through body: one of four samples
constexpr float k_hidden = 0.42f;  ///< opacity of annotations where something stands before them

/// World to the clip space of the sun's parallel view of the shadow sphere, moved by whole texels only, so that the
/// edges of shadows stand still on a vehicle that moves.
Matrix4f light_projection(const Scene& scene) {
  const float radius = scene.shadow_radius, texel = 2.0f * radius / k_shadow_size;
  Matrix4f view = look_at(scene.sun * 3.0f * radius, Vector3f::Zero(), Vector3f::UnitZ());
  const Vector3f center = view.topLeftCorner<3, 3>() * scene.shadow_center;
  view(0, 3) -= texel * std::round(center.x() / texel);
  view(1, 3) -= texel * std::round(center.y() / texel);
  view(2, 3) -= center.z();
  return parallel_projection(radius, radius, radius, 5.0f * radius) * view;
}

}  // namespace

SceneRenderer::SceneRenderer(const GlContext& context, int width, int height)
    : context_(context), width_(width), height_(height) {
  require_size(width, height);
  context.make_current();
  const GlApi& gl = context.gl();
  using namespace shaders;
  programs_.body =
      make_program(context, "body", {frame(), instance(), body_vertex()}, {frame(), light(), body_fragment()});
  programs_.shadow = make_program(context, "shadow", {frame(), instance(), shadow_vertex()}, {shadow_fragment()});
  programs_.ground = make_program(context, "ground", {frame(), ground_vertex()}, {frame(), light(), ground_fragment()});
  programs_.terrain =
      make_program(context, "terrain", {frame(), terrain_vertex()}, {frame(), light(), ground_fragment()});
  programs_.section =
      make_program(context, "section", {frame(), terrain_vertex()}, {frame(), light(), section_fragment()});
  programs_.sky = make_program(context, "sky", {frame(), sky_vertex()}, {frame(), light(), sky_fragment()});
  frame_ = GlBuffer(context);
  instances_ = GlBuffer(context);
  no_vertices_ = GlVertexArray(context);

  shadow_map_ = make_texture(context, GL_DEPTH_COMPONENT24, k_shadow_size, k_shadow_size);
  gl.TextureParameteri(shadow_map_.id(), GL_TEXTURE_COMPARE_MODE, GL_COMPARE_REF_TO_TEXTURE);
  gl.TextureParameteri(shadow_map_.id(), GL_TEXTURE_MIN_FILTER, GL_LINEAR);
  gl.TextureParameteri(shadow_map_.id(), GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  shadow_ = GlFramebuffer(context);
  gl.NamedFramebufferTexture(shadow_.id(), GL_DEPTH_ATTACHMENT, shadow_map_.id(), 0);
  gl.NamedFramebufferDrawBuffer(shadow_.id(), GL_NONE);
  require_complete(context, shadow_, "the shadow map");

  color_samples_ = GlRenderbuffer(context);
  depth_samples_ = GlRenderbuffer(context);
  gl.NamedRenderbufferStorageMultisample(color_samples_.id(), k_samples, GL_SRGB8_ALPHA8, width, height);
  gl.NamedRenderbufferStorageMultisample(depth_samples_.id(), k_samples, GL_DEPTH_COMPONENT24, width, height);
  samples_ = GlFramebuffer(context);
  gl.NamedFramebufferRenderbuffer(samples_.id(), GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, color_samples_.id());
  gl.NamedFramebufferRenderbuffer(samples_.id(), GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, depth_samples_.id());
  require_complete(context, samples_, "the scene");

  picture_color_ = make_texture(context, GL_SRGB8_ALPHA8, width, height);
  picture_ = GlFramebuffer(context);
  gl.NamedFramebufferTexture(picture_.id(), GL_COLOR_ATTACHMENT0, picture_color_.id(), 0);
  require_complete(context, picture_, "the picture");
  context.check("setting up the scene renderer");
}

SceneRenderer::GlMesh SceneRenderer::upload(const Mesh& mesh) const {
  static_assert(sizeof(Vertex) == 10 * sizeof(float));
  const GlApi& gl = context_.gl();
  GlMesh made{GlBuffer(context_), GlBuffer(context_), GlVertexArray(context_),
              static_cast<GLsizei>(mesh.indices.size())};
  const auto bytes = [](const auto& values) { return static_cast<GLsizeiptr>(values.size() * sizeof(values[0])); };
  gl.NamedBufferData(made.vertices.id(), bytes(mesh.vertices), mesh.vertices.data(), GL_STATIC_DRAW);
  gl.NamedBufferData(made.indices.id(), bytes(mesh.indices), mesh.indices.data(), GL_STATIC_DRAW);
  gl.VertexArrayVertexBuffer(made.layout.id(), 0, made.vertices.id(), 0, sizeof(Vertex));
  gl.VertexArrayElementBuffer(made.layout.id(), made.indices.id());
  constexpr std::array<GLint, 4> k_sizes{3, 3, 3, 1};  // position, normal, color, gloss
  GLuint offset = 0;
  for (GLuint attribute = 0; attribute < k_sizes.size(); ++attribute) {
    gl.EnableVertexArrayAttrib(made.layout.id(), attribute);
    gl.VertexArrayAttribFormat(made.layout.id(), attribute, k_sizes[attribute], GL_FLOAT, GL_FALSE, offset);
    gl.VertexArrayAttribBinding(made.layout.id(), attribute, 0);
    offset += static_cast<GLuint>(sizeof(float)) * static_cast<GLuint>(k_sizes[attribute]);
  }
  return made;
}

void SceneRenderer::upload(const std::shared_ptr<const std::vector<SceneMesh>>& meshes) {
  if (meshes == meshes_) return;
  meshes_ = meshes;
  shapes_.clear();
  shadows_.clear();
  for (const SceneMesh& mesh : *meshes) {
    shapes_.push_back(upload(mesh.shape));
    shadows_.push_back(upload(mesh.shadow.indices.empty() ? mesh.shape : mesh.shadow));
  }
}

void SceneRenderer::upload_frame(const Scene& scene) {
  const GlApi& gl = context_.gl();
  const Camera& camera = scene.camera;
  const Footprint& footprint = scene.footprint;
  FrameBlock block;
  block.view_projection = camera.view_projection(static_cast<float>(width_) / static_cast<float>(height_));
  block.from_clip = block.view_projection.inverse();
  block.light_projection = light_projection(scene);
  block.eye << camera.eye, camera.parallel_height > 0.0f ? 0.0f : 1.0f;
  block.view_direction << (camera.target - camera.eye).normalized(), 0.0f;
  block.sun << scene.sun, 2.0f * scene.shadow_radius / k_shadow_size;
  block.footprint << footprint.center, std::cos(footprint.heading), std::sin(footprint.heading);
  block.footprint_size << footprint.half, 0.0f, 0.0f;
  gl.NamedBufferData(frame_.id(), sizeof block, &block, GL_STREAM_DRAW);
  gl.BindBufferBase(GL_UNIFORM_BUFFER, 0, frame_.id());
}

void SceneRenderer::upload_instances(const Scene& scene) {
  const GlApi& gl = context_.gl();
  std::vector<InstanceBlock> blocks;
  const auto add = [&blocks](const Instance& each) {
    InstanceBlock& block = blocks.emplace_back();
    Eigen::Map<Matrix4f>(block.X_WB.data()) = each.X_WB;
    Eigen::Map<Eigen::Vector4f>(block.tint.data()) = each.tint;
    block.look = {each.glow, 0.0f, 0.0f, 0.0f};
  };
  for (const std::vector<Instance>& group : scene.instances) std::for_each(group.begin(), group.end(), add);
  Instance trails;
  trails.glow = 1.0f;
  add(trails);
  trails_instance_ = static_cast<GLint>(blocks.size()) - 1;
  gl.NamedBufferData(instances_.id(), static_cast<GLsizeiptr>(blocks.size() * sizeof(InstanceBlock)), blocks.data(),
                     GL_STREAM_DRAW);
  gl.BindBufferBase(GL_SHADER_STORAGE_BUFFER, 1, instances_.id());
}

bool SceneRenderer::belongs(const Scene& scene, std::size_t mesh, Pass pass) {
  const bool annotation = (*scene.meshes)[mesh].annotation;
  if (pass == Pass::annotations || annotation) return (pass == Pass::annotations) == annotation;
  const bool see_through = scene.see_through == mesh;
  return pass == Pass::shadows || (pass == Pass::see_through) == see_through;
}

void SceneRenderer::draw_instances(const Scene& scene, Pass pass) {
  const GlApi& gl = context_.gl();
  const std::vector<GlMesh>& meshes = pass == Pass::shadows ? shadows_ : shapes_;
  GLint first = 0;
  for (std::size_t i = 0; i < scene.instances.size(); ++i) {
    const auto count = static_cast<GLsizei>(scene.instances[i].size());
    if (count > 0 && belongs(scene, i, pass)) {
      gl.Uniform1i(0, first);
      gl.BindVertexArray(meshes[i].layout.id());
      gl.DrawElementsInstanced(GL_TRIANGLES, meshes[i].num_indices, GL_UNSIGNED_INT, nullptr, count);
      if (pass != Pass::shadows) num_triangles_ += static_cast<std::size_t>(count) * meshes[i].num_indices / 3;
    }
    first += count;
  }
}

void SceneRenderer::draw_bodies(const Scene& scene) {
  const GlApi& gl = context_.gl();
  gl.UseProgram(programs_.body.id());
  gl.Uniform1f(1, 1.0f);
  draw_instances(scene, Pass::solids);
  if (!scene.see_through) return;
  gl.Enable(GL_SAMPLE_ALPHA_TO_COVERAGE);  // needs no order of drawing, unlike blending
  gl.Uniform1f(1, k_ghost);
  draw_instances(scene, Pass::see_through);
  gl.Disable(GL_SAMPLE_ALPHA_TO_COVERAGE);
}

void SceneRenderer::draw_annotations(const Scene& scene) {
  const GlApi& gl = context_.gl();
  gl.UseProgram(programs_.body.id());
  const auto draw_all = [&](float opacity) {
    gl.Uniform1f(1, opacity);
    draw_instances(scene, Pass::annotations);
    if (trails_.num_indices == 0) return;
    gl.Uniform1i(0, trails_instance_);
    gl.BindVertexArray(trails_.layout.id());
    gl.DrawElementsInstanced(GL_TRIANGLES, trails_.num_indices, GL_UNSIGNED_INT, nullptr, 1);
  };
  draw_all(1.0f);
  gl.DepthFunc(GL_GREATER);
  gl.DepthMask(GL_FALSE);
  gl.Enable(GL_BLEND);
  gl.BlendEquation(GL_FUNC_ADD);
  gl.BlendFuncSeparate(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA, GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
  draw_all(k_hidden);
  gl.Disable(GL_BLEND);
  gl.DepthMask(GL_TRUE);
  gl.DepthFunc(GL_LEQUAL);
}

void SceneRenderer::draw_shadow_map(const Scene& scene) {
  const GlApi& gl = context_.gl();
  gl.BindFramebuffer(GL_FRAMEBUFFER, shadow_.id());
  gl.Viewport(0, 0, k_shadow_size, k_shadow_size);
  gl.Clear(GL_DEPTH_BUFFER_BIT);
  gl.Enable(GL_POLYGON_OFFSET_FILL);
  gl.PolygonOffset(1.5f, 2.0f);
  gl.UseProgram(programs_.shadow.id());
  draw_instances(scene, Pass::shadows);
  gl.Disable(GL_POLYGON_OFFSET_FILL);
}

void SceneRenderer::draw_ground(const Scene& scene) {
  const GlApi& gl = context_.gl();
  if (scene.terrain) {
    gl.UseProgram(programs_.terrain.id());
    gl.BindVertexArray(terrain_shape_.layout.id());
    gl.DrawElementsInstanced(GL_TRIANGLES, terrain_shape_.num_indices, GL_UNSIGNED_INT, nullptr, 1);
    return;
  }
  gl.UseProgram(programs_.ground.id());
  gl.BindVertexArray(no_vertices_.id());
  gl.DrawArrays(GL_TRIANGLES, 0, 6);
}

void SceneRenderer::draw_colors(const Scene& scene) {
  const GlApi& gl = context_.gl();
  gl.BindFramebuffer(GL_FRAMEBUFFER, samples_.id());
  gl.Viewport(0, 0, width_, height_);
  gl.Enable(GL_FRAMEBUFFER_SRGB);
  gl.Clear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
  gl.BindTextureUnit(0, shadow_map_.id());
  draw_bodies(scene);
  if (scene.ground) draw_ground(scene);  // after the bodies, so that what they hide costs nothing
  if (section_.num_indices > 0) {
    gl.UseProgram(programs_.section.id());
    gl.BindVertexArray(section_.layout.id());
    gl.DrawElementsInstanced(GL_TRIANGLES, section_.num_indices, GL_UNSIGNED_INT, nullptr, 1);
  }
  gl.BindVertexArray(no_vertices_.id());
  gl.UseProgram(programs_.sky.id());
  gl.DrawArrays(GL_TRIANGLES, 0, 3);
  draw_annotations(scene);
  gl.Disable(GL_FRAMEBUFFER_SRGB);
}

void SceneRenderer::draw(const Scene& scene) {
  context_.make_current();
  const GlApi& gl = context_.gl();
  num_triangles_ = 0;
  upload(scene.meshes);
  if (scene.terrain != terrain_) {
    terrain_ = scene.terrain;
    terrain_shape_ = terrain_ ? upload(*terrain_) : GlMesh{};
  }
  section_ = upload(scene.section);
  trails_ = upload(scene.trails);
  upload_frame(scene);
  upload_instances(scene);
  gl.Disable(GL_SCISSOR_TEST);
  gl.Disable(GL_BLEND);
  gl.Enable(GL_DEPTH_TEST);
  gl.DepthFunc(GL_LEQUAL);
  gl.Enable(GL_CULL_FACE);
  gl.CullFace(GL_BACK);
  draw_shadow_map(scene);
  draw_colors(scene);
  gl.Disable(GL_DEPTH_TEST);
  gl.Disable(GL_CULL_FACE);
  // Resolves the samples and turns the rows over in one go.
  gl.BlitNamedFramebuffer(samples_.id(), picture_.id(), 0, 0, width_, height_, 0, height_, width_, 0,
                          GL_COLOR_BUFFER_BIT, GL_NEAREST);
  context_.check("drawing a scene");
}

}  // namespace grouser
