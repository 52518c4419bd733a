#pragma once
#include "render/gl_objects.h"
#include "render/scene.h"

namespace grouser {

/// Draws scenes of one size: a shadow map, then 4 x multisampled colour in sRGB, resolved into a picture.
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
  struct Programs {
    GlProgram body, shadow, ground, terrain, section, sky;
  };
  [[nodiscard]] GlMesh upload(const Mesh& mesh) const;
  void upload(const std::shared_ptr<const std::vector<SceneMesh>>& meshes);
  void upload_frame(const Scene& scene);
  void upload_instances(const Scene& scene);
  /// Which meshes of a scene a pass draws.
  enum class Pass { shadows, solids, see_through, annotations };
  [[nodiscard]] static bool belongs(const Scene& scene, std::size_t mesh, Pass pass);
  void draw_instances(const Scene& scene, Pass pass);
  void draw_bodies(const Scene& scene);
  void draw_annotations(const Scene& scene);
  void draw_shadow_map(const Scene& scene);
  void draw_ground(const Scene& scene);
  void draw_colors(const Scene& scene);

  const GlContext& context_;
  int width_, height_;
  Programs programs_;
  GlBuffer frame_, instances_;
  GlVertexArray no_vertices_;
  GlTexture shadow_map_, picture_color_;
  GlRenderbuffer color_samples_, depth_samples_;
  GlFramebuffer shadow_, samples_, picture_;
  std::shared_ptr<const std::vector<SceneMesh>> meshes_;
  std::vector<GlMesh> shapes_, shadows_;
  std::shared_ptr<const Mesh> terrain_;
  GlMesh terrain_shape_, section_, trails_;
  GLint trails_instance_ = 0;
  std::size_t num_triangles_ = 0;
};

}  // namespace grouser
