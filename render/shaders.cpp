#include "render/shaders.h"

#define GROUSER_SHADER(name) extern "C" const char shader_##name##_begin[], shader_##name##_end[];
GROUSER_SHADERS(GROUSER_SHADER)
#undef GROUSER_SHADER

namespace grouser::shaders {

#define GROUSER_SHADER(name) \
  std::string_view name() { return {shader_##name##_begin, shader_##name##_end}; }
GROUSER_SHADERS(GROUSER_SHADER)
#undef GROUSER_SHADER

}  // namespace grouser::shaders
