#pragma once
#include <memory>
#include <stdexcept>
#include <string>

#include "render/gl_api.h"

namespace grouser {

/// The GL implementation is missing, refused something or reported an error: a fault of the installation or of render/.
class GlError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// An off-screen OpenGL 4.5 core context. It is the only thing that knows OSMesa, so that EGL surfaceless can replace
/// it. Drawing goes to framebuffer objects of any size; the context's own buffer is a dummy. Use from one thread at a
/// time.
class GlContext {
 public:
  /// Makes itself current. `pixels`: of the largest picture that is to be drawn. Throws GlError, and std::bad_alloc
  /// where there is too little memory for it.
  explicit GlContext(std::size_t pixels);
  ~GlContext();
  GlContext(const GlContext&) = delete;
  GlContext& operator=(const GlContext&) = delete;

  [[nodiscard]] const GlApi& gl() const;
  void make_current() const;
  /// Throws GlError when GL recorded an error since the last call; `where` names the work that was done.
  void check(const std::string& where) const;
  /// "Mesa 22.3.6, llvmpipe (LLVM 15.0.6, 256 bits)"
  [[nodiscard]] std::string description() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace grouser
