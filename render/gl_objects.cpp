#include "render/gl_objects.h"

namespace grouser {
namespace {

using GlShader = GlObject<GlShaderKind>;

GlShader compile(const GlContext& context, const std::string& name, GLenum stage,
                 const std::vector<std::string_view>& parts) {
  const GlApi& gl = context.gl();
  GlShader shader(context, stage);
  std::vector<const GLchar*> texts;
  std::vector<GLint> lengths;
  for (const std::string_view part : parts) {
    texts.push_back(part.data());
    lengths.push_back(static_cast<GLint>(part.size()));
  }
  gl.ShaderSource(shader.id(), static_cast<GLsizei>(parts.size()), texts.data(), lengths.data());
  gl.CompileShader(shader.id());
  GLint good = GL_FALSE;
  gl.GetShaderiv(shader.id(), GL_COMPILE_STATUS, &good);
  if (good == GL_FALSE) {
    std::string log(4096, '\0');
    GLsizei length = 0;
    gl.GetShaderInfoLog(shader.id(), static_cast<GLsizei>(log.size()), &length, log.data());
    log.resize(static_cast<std::size_t>(length));
    throw GlError("shader " + name + ": " + log);
  }
  return shader;
}

}  // namespace

GlProgram make_program(const GlContext& context, const std::string& name, const std::vector<std::string_view>& vertex,
                       const std::vector<std::string_view>& fragment) {
  const GlApi& gl = context.gl();
  const GlShader vertex_shader = compile(context, name + " (vertex)", GL_VERTEX_SHADER, vertex);
  const GlShader fragment_shader = compile(context, name + " (fragment)", GL_FRAGMENT_SHADER, fragment);
  GlProgram program(context);
  gl.AttachShader(program.id(), vertex_shader.id());
  gl.AttachShader(program.id(), fragment_shader.id());
  gl.LinkProgram(program.id());
  GLint good = GL_FALSE;
  gl.GetProgramiv(program.id(), GL_LINK_STATUS, &good);
  if (good == GL_FALSE) {
    std::string log(4096, '\0');
    GLsizei length = 0;
    gl.GetProgramInfoLog(program.id(), static_cast<GLsizei>(log.size()), &length, log.data());
    log.resize(static_cast<std::size_t>(length));
    throw GlError("program " + name + ": " + log);
  }
  return program;
}

GlTexture make_texture(const GlContext& context, GLenum format, int width, int height) {
  const GlApi& gl = context.gl();
  GlTexture texture(context);
  gl.TextureStorage2D(texture.id(), 1, format, width, height);
  gl.TextureParameteri(texture.id(), GL_TEXTURE_MIN_FILTER, GL_NEAREST);
  gl.TextureParameteri(texture.id(), GL_TEXTURE_MAG_FILTER, GL_NEAREST);
  gl.TextureParameteri(texture.id(), GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
  gl.TextureParameteri(texture.id(), GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
  return texture;
}

void require_complete(const GlContext& context, const GlFramebuffer& framebuffer, const std::string& name) {
  if (context.gl().CheckNamedFramebufferStatus(framebuffer.id(), GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE)
    throw GlError("framebuffer of " + name + " is not complete");
}

Image read_image(const GlContext& context, const GlFramebuffer& framebuffer, int width, int height) {
  const GlApi& gl = context.gl();
  Image image{width, height, std::vector<std::uint8_t>(static_cast<std::size_t>(width) * height * 3)};
  gl.BindFramebuffer(GL_READ_FRAMEBUFFER, framebuffer.id());
  gl.PixelStorei(GL_PACK_ALIGNMENT, 1);
  gl.ReadPixels(0, 0, width, height, GL_BGR, GL_UNSIGNED_BYTE, image.bgr.data());
  context.check("reading a picture");
  return image;
}

}  // namespace grouser
