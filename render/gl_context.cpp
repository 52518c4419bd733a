#include "render/gl_context.h"

#include <GL/osmesa.h>
#include <sys/mman.h>

#include <array>
#include <cstdint>
#include <new>

namespace grouser {

struct GlContext::Impl {
  static constexpr int k_dummy_size = 16;
  OSMesaContext context = nullptr;
  // OSMesa binds every context to client memory, single-sampled; all drawing goes to framebuffer objects instead.
  std::array<std::uint32_t, k_dummy_size * k_dummy_size> dummy{};
  GlApi gl;
  std::string message;  ///< first complaint of debug output since the last check

  ~Impl() {
    if (context != nullptr) OSMesaDestroyContext(context);
  }

  void load() {
#define GROUSER_GL_LOAD(UPPER, Name)                                                \
  gl.Name = reinterpret_cast<PFNGL##UPPER##PROC>(OSMesaGetProcAddress("gl" #Name)); \
  if (gl.Name == nullptr) throw GlError("OSMesa has no function gl" #Name);
    GROUSER_GL_FUNCTIONS(GROUSER_GL_LOAD)
#undef GROUSER_GL_LOAD
  }

  void record_debug_output() {
    gl.Enable(GL_DEBUG_OUTPUT);
    gl.Enable(GL_DEBUG_OUTPUT_SYNCHRONOUS);
    gl.DebugMessageCallback(
        [](GLenum, GLenum type, GLuint, GLenum, GLsizei, const GLchar* text, const void* user) {
          auto& first = *static_cast<std::string*>(const_cast<void*>(user));
          if (type == GL_DEBUG_TYPE_ERROR && first.empty()) first = text;
        },
        &message);
  }
};

namespace {

/// Mesa and LLVM take memory without looking whether they got it, and crash; what they need is asked for before.
void require_memory(std::size_t pixels) {
  constexpr std::size_t k_small = std::size_t{768} << 20;  // address space, measured for pictures up to 1280 x 720
  constexpr std::size_t k_of_pixel = 64;                   // 42 measured: samples, depths, the picture and its copy
  const std::size_t needed = k_small + k_of_pixel * pixels;
  void* const room = mmap(nullptr, needed, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (room == MAP_FAILED) throw std::bad_alloc();
  munmap(room, needed);
}

}  // namespace

GlContext::GlContext(std::size_t pixels) : impl_(std::make_unique<Impl>()) {
  require_memory(pixels);
  const std::array<int, 11> attributes{OSMESA_FORMAT,
                                       OSMESA_RGBA,
                                       OSMESA_DEPTH_BITS,
                                       24,
                                       OSMESA_PROFILE,
                                       OSMESA_CORE_PROFILE,
                                       OSMESA_CONTEXT_MAJOR_VERSION,
                                       4,
                                       OSMESA_CONTEXT_MINOR_VERSION,
                                       5,
                                       0};
  impl_->context = OSMesaCreateContextAttribs(attributes.data(), nullptr);
  if (impl_->context == nullptr) throw GlError("OSMesa offers no OpenGL 4.5 core context");
  make_current();
  impl_->load();
#ifndef NDEBUG
  impl_->record_debug_output();
#endif
}

GlContext::~GlContext() = default;

const GlApi& GlContext::gl() const { return impl_->gl; }

void GlContext::make_current() const {
  if (OSMesaGetCurrentContext() == impl_->context) return;
  if (OSMesaMakeCurrent(impl_->context, impl_->dummy.data(), GL_UNSIGNED_BYTE, Impl::k_dummy_size,
                        Impl::k_dummy_size) == GL_FALSE) {
    throw GlError("OSMesa refused to make its context current");
  }
}

void GlContext::check(const std::string& where) const {
  const GLenum code = impl_->gl.GetError();
  if (code == GL_NO_ERROR) return;
  std::string text = "OpenGL error " + std::to_string(code) + " in " + where;
  if (!impl_->message.empty()) text += ": " + impl_->message;
  impl_->message.clear();
  while (impl_->gl.GetError() != GL_NO_ERROR) {
  }
  throw GlError(text);
}

std::string GlContext::description() const {
  const auto text = [this](GLenum name) {
    return std::string(reinterpret_cast<const char*>(impl_->gl.GetString(name)));
  };
  return text(GL_VERSION) + ", " + text(GL_RENDERER);
}

}  // namespace grouser
