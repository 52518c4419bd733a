#pragma once
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "render/gl_context.h"
#include "render/image.h"

/// Owners of GL names. Each remembers its context, which must outlive it.
namespace grouser {

template <typename Kind>
class GlObject {
 public:
  GlObject() = default;
  template <typename... Arguments>
  explicit GlObject(const GlContext& context, Arguments... arguments) : context_(&context) {
    Kind::create(context.gl(), id_, arguments...);
  }
  ~GlObject() { release(); }
  GlObject(GlObject&& other) noexcept
      : context_(std::exchange(other.context_, nullptr)), id_(std::exchange(other.id_, 0)) {}
  GlObject& operator=(GlObject&& other) noexcept {
    std::swap(context_, other.context_);
    std::swap(id_, other.id_);
    return *this;
  }
  [[nodiscard]] GLuint id() const { return id_; }

 private:
  void release() {
    if (id_ == 0) return;
    context_->make_current();
    Kind::destroy(context_->gl(), id_);
  }
  const GlContext* context_ = nullptr;
  GLuint id_ = 0;
};

struct GlBufferKind {
  static void create(const GlApi& gl, GLuint& id) { gl.CreateBuffers(1, &id); }
  static void destroy(const GlApi& gl, GLuint id) { gl.DeleteBuffers(1, &id); }
};
struct GlTextureKind {
  static void create(const GlApi& gl, GLuint& id) { gl.CreateTextures(GL_TEXTURE_2D, 1, &id); }
  static void destroy(const GlApi& gl, GLuint id) { gl.DeleteTextures(1, &id); }
};
struct GlRenderbufferKind {
  static void create(const GlApi& gl, GLuint& id) { gl.CreateRenderbuffers(1, &id); }
  static void destroy(const GlApi& gl, GLuint id) { gl.DeleteRenderbuffers(1, &id); }
};
struct GlFramebufferKind {
  static void create(const GlApi& gl, GLuint& id) { gl.CreateFramebuffers(1, &id); }
  static void destroy(const GlApi& gl, GLuint id) { gl.DeleteFramebuffers(1, &id); }
};
struct GlVertexArrayKind {
  static void create(const GlApi& gl, GLuint& id) { gl.CreateVertexArrays(1, &id); }
  static void destroy(const GlApi& gl, GLuint id) { gl.DeleteVertexArrays(1, &id); }
};
struct GlShaderKind {
  static void create(const GlApi& gl, GLuint& id, GLenum stage) { id = gl.CreateShader(stage); }
  static void destroy(const GlApi& gl, GLuint id) { gl.DeleteShader(id); }
};
struct GlProgramKind {
  static void create(const GlApi& gl, GLuint& id) { id = gl.CreateProgram(); }
  static void destroy(const GlApi& gl, GLuint id) { gl.DeleteProgram(id); }
};

using GlBuffer = GlObject<GlBufferKind>;
using GlTexture = GlObject<GlTextureKind>;
using GlRenderbuffer = GlObject<GlRenderbufferKind>;
using GlFramebuffer = GlObject<GlFramebufferKind>;
using GlVertexArray = GlObject<GlVertexArrayKind>;
using GlProgram = GlObject<GlProgramKind>;

/// Compiles and links; the parts of a stage are joined in order. `name` stands in the error. Throws GlError.
[[nodiscard]] GlProgram make_program(const GlContext& context, const std::string& name,
                                     const std::vector<std::string_view>& vertex,
                                     const std::vector<std::string_view>& fragment);

/// A texture of one level, nearest filtering, clamped.
[[nodiscard]] GlTexture make_texture(const GlContext& context, GLenum format, int width, int height);

/// Throws GlError unless the framebuffer is complete.
void require_complete(const GlContext& context, const GlFramebuffer& framebuffer, const std::string& name);

/// The colour of a single-sampled framebuffer whose first row is the picture's top.
[[nodiscard]] Image read_image(const GlContext& context, const GlFramebuffer& framebuffer, int width, int height);

}  // namespace grouser
