#pragma once
#include <GL/glcorearb.h>

/// The OpenGL 4.5 core functions that render/ calls, as typed members (`gl.Clear(...)`), so that no symbol of another
/// GL library in the process can be picked up by accident.
namespace grouser {

// clang-format off
#define GROUSER_GL_FUNCTIONS(X) \
  X(ATTACHSHADER, AttachShader) X(BINDBUFFERBASE, BindBufferBase) X(BINDFRAMEBUFFER, BindFramebuffer) \
  X(BINDTEXTUREUNIT, BindTextureUnit) X(BINDVERTEXARRAY, BindVertexArray) X(BLENDEQUATION, BlendEquation) \
  X(BLENDFUNCSEPARATE, BlendFuncSeparate) X(BLITNAMEDFRAMEBUFFER, BlitNamedFramebuffer) \
  X(CHECKNAMEDFRAMEBUFFERSTATUS, CheckNamedFramebufferStatus) X(CLEAR, Clear) X(CLEARCOLOR, ClearColor) \
  X(COMPILESHADER, CompileShader) X(CREATEBUFFERS, CreateBuffers) X(CREATEFRAMEBUFFERS, CreateFramebuffers) \
  X(CREATEPROGRAM, CreateProgram) X(CREATERENDERBUFFERS, CreateRenderbuffers) X(CREATESHADER, CreateShader) \
  X(CREATETEXTURES, CreateTextures) X(CREATEVERTEXARRAYS, CreateVertexArrays) X(CULLFACE, CullFace) \
  X(DEBUGMESSAGECALLBACK, DebugMessageCallback) X(DELETEBUFFERS, DeleteBuffers) \
  X(DELETEFRAMEBUFFERS, DeleteFramebuffers) X(DELETEPROGRAM, DeleteProgram) \
  X(DELETERENDERBUFFERS, DeleteRenderbuffers) X(DELETESHADER, DeleteShader) X(DELETETEXTURES, DeleteTextures) \
  X(DELETEVERTEXARRAYS, DeleteVertexArrays) X(DEPTHFUNC, DepthFunc) X(DEPTHMASK, DepthMask) X(DISABLE, Disable) X(DRAWARRAYS, DrawArrays) \
  X(DRAWARRAYSINSTANCED, DrawArraysInstanced) X(DRAWELEMENTSINSTANCED, DrawElementsInstanced) X(ENABLE, Enable) \
  X(ENABLEVERTEXARRAYATTRIB, EnableVertexArrayAttrib) X(GETERROR, GetError) X(GETINTEGERV, GetIntegerv) \
  X(GETPROGRAMINFOLOG, GetProgramInfoLog) X(GETPROGRAMIV, GetProgramiv) X(GETSHADERINFOLOG, GetShaderInfoLog) \
  X(GETSHADERIV, GetShaderiv) X(GETSTRING, GetString) X(LINKPROGRAM, LinkProgram) \
  X(NAMEDBUFFERDATA, NamedBufferData) X(NAMEDFRAMEBUFFERDRAWBUFFER, NamedFramebufferDrawBuffer) \
  X(NAMEDFRAMEBUFFERRENDERBUFFER, NamedFramebufferRenderbuffer) X(NAMEDFRAMEBUFFERTEXTURE, NamedFramebufferTexture) \
  X(NAMEDRENDERBUFFERSTORAGEMULTISAMPLE, NamedRenderbufferStorageMultisample) X(PIXELSTOREI, PixelStorei) \
  X(POLYGONOFFSET, PolygonOffset) X(READPIXELS, ReadPixels) X(SCISSOR, Scissor) X(SHADERSOURCE, ShaderSource) \
  X(TEXTUREPARAMETERI, TextureParameteri) X(TEXTURESTORAGE2D, TextureStorage2D) \
  X(TEXTURESUBIMAGE2D, TextureSubImage2D) X(UNIFORM1F, Uniform1f) X(UNIFORM1I, Uniform1i) X(UNIFORM2F, Uniform2f) \
  X(UNIFORM4F, Uniform4f) X(USEPROGRAM, UseProgram) X(VERTEXARRAYATTRIBBINDING, VertexArrayAttribBinding) \
  X(VERTEXARRAYATTRIBFORMAT, VertexArrayAttribFormat) X(VERTEXARRAYELEMENTBUFFER, VertexArrayElementBuffer) \
  X(VERTEXARRAYVERTEXBUFFER, VertexArrayVertexBuffer) X(VIEWPORT, Viewport)
// clang-format on

struct GlApi {
#define GROUSER_GL_MEMBER(UPPER, Name) PFNGL##UPPER##PROC Name = nullptr;
  GROUSER_GL_FUNCTIONS(GROUSER_GL_MEMBER)
#undef GROUSER_GL_MEMBER
};

}  // namespace grouser
