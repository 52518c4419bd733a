#pragma once
#include <string_view>

/// GLSL sources, embedded from render/shaders/ at build. frame() and the fragment shadow begin with the #version line.
namespace grouser::shaders {

// clang-format off
#define GROUSER_SHADERS(X) \
  X(frame) X(instance) X(light) X(body_vertex) X(body_fragment) X(shadow_vertex) X(shadow_fragment) \
  X(ground_vertex) X(ground_fragment) X(terrain_vertex) X(section_fragment) X(sky_vertex) X(sky_fragment) X(page) X(line_vertex) X(line_fragment) \
  X(band_vertex) X(band_fragment) X(box_vertex) X(box_fragment) X(cover_vertex) X(cover_fragment) X(glyph_vertex) \
  X(glyph_fragment)
// clang-format on

#define GROUSER_SHADER(name) [[nodiscard]] std::string_view name();
GROUSER_SHADERS(GROUSER_SHADER)
#undef GROUSER_SHADER

}  // namespace grouser::shaders
