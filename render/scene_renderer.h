#pragma once
#include "render/gl_objects.h"
#include "render/scene.h"
#include "render/visible.h"

namespace grouser {

/// Draws scenes of one size: a shadow map, then 4 x multisampled colour (sRGB), resolved into a picture. What lies out
/// of the picture is left out, what is far is drawn in less detail, and the near before the far, which it hides.
class SceneRenderer {
 public:
  /// The context must outlive the renderer. Throws InputError unless width and height are even and 16..8192, GlError.
  SceneRenderer(const GlContext& context, int width, int height);

  /// Into picture(). Throws GlError.
  void draw(const Scene& scene);
  /// Single-sampled RGBA of the last scene, top row first; further drawing on it (text) is welcome.
  [[nodiscard]] const GlFramebuffer& picture() const { return picture_; }
  [[nodiscard]] Image read() const { return read_image(context_, picture_, width_, height_); }

  [[nodiscard]] int width() const { return width_; }
  [[nodiscard]] int height() const { return height_; }
  /// Triangles of the last scene, without its shadow pass.
  [[nodiscard]] std::size_t num_triangles() const { return num_triangles_; }

 private:
  struct GlMesh {
    GlBuffer vertices, indices;
    GlVertexArray layout;
    GLsizei num_indices = 0;
  };
  /// What the sun shines on, for either softness of shadows.
  struct LitPrograms {
    GlProgram body, ground, terrain;
  };
  struct Programs {
    LitPrograms soft, hard;
    GlProgram shadow, section, sky;
  };
  /// One mesh in the details that it has.
  struct Shapes {
    std::array<GlMesh, k_num_details> shape;  ///< without indices: as the middle one
    GlMesh shadow;
    [[nodiscard]] const GlMesh& of(Detail::Level level) const;
  };
  [[nodiscard]] LitPrograms make_lit_programs(std::string_view option) const;
  [[nodiscard]] GlMesh upload(const Mesh& mesh) const;
  void upload(const std::shared_ptr<const std::vector<SceneMesh>>& meshes);
  void upload_frame(const Scene& scene);
  void upload_instances(const VisibleParts& visible);
  void draw_mesh(const GlMesh& mesh, std::size_t count = 1) const;
  void draw_instances(const GlMesh& mesh, std::size_t first, std::size_t count) const;
  void draw_parts(const std::vector<PartGroup>& groups);
  void draw_sky() const;
  void draw_bodies(const VisibleParts& visible);
  void draw_annotations(const VisibleParts& visible);
  void draw_shadow_map(const VisibleParts& visible);
  void draw_ground(const Scene& scene);
  void draw_colors(const Scene& scene, const VisibleParts& visible);

  const GlContext& context_;
  int width_, height_;
  Programs programs_;
  const LitPrograms* lit_ = nullptr;  ///< of the last scene
  GlBuffer frame_, instances_;
  GlVertexArray no_vertices_;
  GlTexture shadow_map_, picture_color_;
  GlRenderbuffer color_samples_, depth_samples_;
  GlFramebuffer shadow_, samples_, picture_;
  std::shared_ptr<const std::vector<SceneMesh>> meshes_;
  std::vector<Shapes> shapes_;
  std::vector<Ball> balls_;
  std::shared_ptr<const Mesh> terrain_;
  GlMesh terrain_shape_, section_, trails_;
  std::size_t trails_instance_ = 0;
  std::size_t num_triangles_ = 0;
};

}  // namespace grouser
