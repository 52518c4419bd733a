#include "render/scene_renderer.h"

#include <algorithm>
#include <cmath>

#include "model/errors.h"
#include "render/shaders.h"

namespace grouser {
namespace {

constexpr int k_shadow_size = 2048;
constexpr int k_samples = 4;                     ///< llvmpipe offers 1 or 4
constexpr GLsizei k_sky_vertices = 32 * 24 * 6;  ///< fields of shaders/sky_vertex.glsl

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
      {"picture", "size", "even numbers from 16 to 8192", std::to_string(width) + " x " + std::to_string(height), ""});
}

constexpr float k_ghost = 0.3f;    ///< share that is drawn of a see-through body: one of four samples
constexpr float k_hidden = 0.42f;  ///< opacity of annotations where something stands before them

/// Whether a pixel at the vehicle is so much larger than a texel of the shadow map that nothing is left to soften.
bool pixels_are_large(const Scene& scene, int height) {
  const float distance = scene.camera.distance_of(scene.shadow_center),
              texel = 2.0f * scene.shadow_radius / k_shadow_size;
  return 1.0f > 1.5f * texel * scene.camera.pixels_per_metre(distance, height);
}

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
  programs_.soft = make_lit_programs("");
  programs_.hard = make_lit_programs("#define LARGE_PIXELS\n");
  programs_.shadow = make_program(context, "shadow", {frame(), instance(), shadow_vertex()}, {shadow_fragment()});
  programs_.section =
      make_program(context, "section", {frame(), terrain_vertex()}, {frame(), light(), section_fragment()});
  programs_.sky = make_program(context, "sky", {frame(), light(), sky_vertex()}, {sky_fragment()});
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
  gl.NamedRenderbufferStorageMultisample(color_samples_.id(), k_samples, GL_RGBA8, width, height);
  gl.NamedRenderbufferStorageMultisample(depth_samples_.id(), k_samples, GL_DEPTH_COMPONENT24, width, height);
  samples_ = GlFramebuffer(context);
  gl.NamedFramebufferRenderbuffer(samples_.id(), GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, color_samples_.id());
  gl.NamedFramebufferRenderbuffer(samples_.id(), GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, depth_samples_.id());
  require_complete(context, samples_, "the scene");

  picture_color_ = make_texture(context, GL_RGBA8, width, height);
  picture_ = GlFramebuffer(context);
  gl.NamedFramebufferTexture(picture_.id(), GL_COLOR_ATTACHMENT0, picture_color_.id(), 0);
  require_complete(context, picture_, "the picture");
  context.check("setting up the scene renderer");
}

SceneRenderer::LitPrograms SceneRenderer::make_lit_programs(std::string_view option) const {
  using namespace shaders;
  const auto make = [&](const std::string& name, const std::vector<std::string_view>& vertex,
                        std::string_view fragment) {
    return make_program(context_, name, vertex, {frame(), option, light(), fragment});
  };
  return {make("body", {frame(), light(), instance(), body_vertex()}, body_fragment()),
          make("ground", {frame(), ground_vertex()}, ground_fragment()),
          make("terrain", {frame(), terrain_vertex()}, ground_fragment())};
}

const SceneRenderer::GlMesh& SceneRenderer::Shapes::of(Detail::Level level) const {
  return shape[level].num_indices > 0 ? shape[level] : shape[Detail::middle];
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
  balls_.clear();
  const auto if_any = [this](const Mesh& mesh) { return mesh.indices.empty() ? GlMesh{} : upload(mesh); };
  for (const SceneMesh& mesh : *meshes) {
    Shapes& shapes = shapes_.emplace_back();
    shapes.shape[Detail::coarse] = if_any(mesh.coarse);
    shapes.shape[Detail::middle] = upload(mesh.shape);
    shapes.shape[Detail::fine] = if_any(mesh.fine);
    shapes.shadow = upload(mesh.shadow.indices.empty() ? mesh.shape : mesh.shadow);
    balls_.push_back(ball_round(mesh.shape));
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

void SceneRenderer::upload_instances(const VisibleParts& visible) {
  const GlApi& gl = context_.gl();
  std::vector<InstanceBlock> blocks;
  const auto add = [&blocks](const Instance& each) {
    InstanceBlock& block = blocks.emplace_back();
    Eigen::Map<Matrix4f>(block.X_WB.data()) = each.X_WB;
    Eigen::Map<Eigen::Vector4f>(block.tint.data()) = each.tint;
    block.look = {each.glow, 0.0f, 0.0f, 0.0f};
  };
  for (const Instance* each : visible.instances()) add(*each);
  trails_instance_ = blocks.size();
  Instance trails;
  trails.glow = 1.0f;
  add(trails);
  gl.NamedBufferData(instances_.id(), static_cast<GLsizeiptr>(blocks.size() * sizeof(InstanceBlock)), blocks.data(),
                     GL_STREAM_DRAW);
  gl.BindBufferBase(GL_SHADER_STORAGE_BUFFER, 1, instances_.id());
}

void SceneRenderer::draw_mesh(const GlMesh& mesh, std::size_t count) const {
  const GlApi& gl = context_.gl();
  gl.BindVertexArray(mesh.layout.id());
  gl.DrawElementsInstanced(GL_TRIANGLES, mesh.num_indices, GL_UNSIGNED_INT, nullptr, static_cast<GLsizei>(count));
}

void SceneRenderer::draw_instances(const GlMesh& mesh, std::size_t first, std::size_t count) const {
  context_.gl().Uniform1i(0, static_cast<GLint>(first));
  draw_mesh(mesh, count);
}

void SceneRenderer::draw_parts(const std::vector<PartGroup>& groups) {
  for (const PartGroup& group : groups) {
    const GlMesh& mesh = shapes_[group.mesh].of(group.level);
    draw_instances(mesh, group.first, group.instances.size());
    num_triangles_ += group.instances.size() * static_cast<std::size_t>(mesh.num_indices) / 3;
  }
}

void SceneRenderer::draw_bodies(const VisibleParts& visible) {
  const GlApi& gl = context_.gl();
  gl.UseProgram(lit_->body.id());
  gl.Uniform1f(1, 1.0f);
  draw_parts(visible.solids);
  gl.Enable(GL_SAMPLE_ALPHA_TO_COVERAGE);  // needs no order of drawing, unlike blending
  gl.Uniform1f(1, k_ghost);
  draw_parts(visible.see_through);
  gl.Disable(GL_SAMPLE_ALPHA_TO_COVERAGE);
}

void SceneRenderer::draw_annotations(const VisibleParts& visible) {
  const GlApi& gl = context_.gl();
  gl.UseProgram(lit_->body.id());
  const auto draw_all = [&](float opacity) {
    gl.Uniform1f(1, opacity);
    draw_parts(visible.annotations);
    if (trails_.num_indices > 0) draw_instances(trails_, trails_instance_, 1);
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

void SceneRenderer::draw_shadow_map(const VisibleParts& visible) {
  const GlApi& gl = context_.gl();
  gl.BindFramebuffer(GL_FRAMEBUFFER, shadow_.id());
  gl.Viewport(0, 0, k_shadow_size, k_shadow_size);
  gl.Clear(GL_DEPTH_BUFFER_BIT);
  gl.Enable(GL_POLYGON_OFFSET_FILL);
  gl.PolygonOffset(1.5f, 2.0f);
  gl.UseProgram(programs_.shadow.id());
  for (const PartGroup& group : visible.casters)
    draw_instances(shapes_[group.mesh].shadow, group.first, group.instances.size());
  gl.Disable(GL_POLYGON_OFFSET_FILL);
}

/// First and without depth: nothing is to be found out about it.
void SceneRenderer::draw_sky() const {
  const GlApi& gl = context_.gl();
  gl.Disable(GL_DEPTH_TEST);
  gl.BindVertexArray(no_vertices_.id());
  gl.UseProgram(programs_.sky.id());
  gl.DrawArrays(GL_TRIANGLES, 0, k_sky_vertices);
  gl.Enable(GL_DEPTH_TEST);
}

void SceneRenderer::draw_ground(const Scene& scene) {
  const GlApi& gl = context_.gl();
  if (scene.terrain) {
    gl.UseProgram(lit_->terrain.id());
    draw_mesh(terrain_shape_);
    return;
  }
  gl.UseProgram(lit_->ground.id());
  gl.BindVertexArray(no_vertices_.id());
  gl.DrawArrays(GL_TRIANGLES, 0, 6);
}

void SceneRenderer::draw_colors(const Scene& scene, const VisibleParts& visible) {
  const GlApi& gl = context_.gl();
  gl.BindFramebuffer(GL_FRAMEBUFFER, samples_.id());
  gl.Viewport(0, 0, width_, height_);
  gl.Clear(GL_DEPTH_BUFFER_BIT);
  draw_sky();
  gl.BindTextureUnit(0, shadow_map_.id());
  draw_bodies(visible);
  if (scene.ground) draw_ground(scene);  // after the bodies, so that what they hide costs nothing
  if (section_.num_indices > 0) {
    gl.UseProgram(programs_.section.id());
    draw_mesh(section_);
  }
  draw_annotations(visible);
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
  lit_ = pixels_are_large(scene, height_) ? &programs_.hard : &programs_.soft;
  const VisibleParts visible = visible_parts(scene, balls_, width_, height_);
  upload_frame(scene);
  upload_instances(visible);
  gl.Disable(GL_SCISSOR_TEST);
  gl.Disable(GL_BLEND);
  gl.Enable(GL_DEPTH_TEST);
  gl.DepthFunc(GL_LEQUAL);
  gl.Enable(GL_CULL_FACE);
  gl.CullFace(GL_BACK);
  draw_shadow_map(visible);
  draw_colors(scene, visible);
  gl.Disable(GL_DEPTH_TEST);
  gl.Disable(GL_CULL_FACE);
  // Resolves the samples and turns the rows over in one go.
  gl.BlitNamedFramebuffer(samples_.id(), picture_.id(), 0, 0, width_, height_, 0, height_, width_, 0,
                          GL_COLOR_BUFFER_BIT, GL_NEAREST);
  context_.check("drawing a scene");
}

}  // namespace grouser
