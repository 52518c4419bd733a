#include "render/plot_theme.h"

namespace grouser {
namespace {

Rgb hex(unsigned value) {
  const auto part = [value](unsigned shift) { return static_cast<float>((value >> shift) & 0xFFU) / 255.0f; };
  return {part(16), part(8), part(0)};
}

// Hues that stay apart in the common kinds of colour blindness, blue and orange first.
const PlotTheme k_light{{hex(0xffffff)},
                        {hex(0x23262d)},
                        {hex(0x5b616c)},
                        {hex(0xe3e5ea)},
                        {hex(0xf1f2f5)},
                        {hex(0x7a808c)},
                        {hex(0xb4b8c2)},
                        {hex(0x8a5a00)},
                        {hex(0xd5d8de)},
                        {hex(0x1f6bb3), hex(0xd9590d), hex(0x2a8a57), hex(0x9747a8), hex(0xb38600), hex(0x138a9c),
                         hex(0xc2315b), hex(0x6b6f7a)}};
const PlotTheme k_dark{{hex(0x171a21)},
                       {hex(0xe6e8ee)},
                       {hex(0xa3a9b6)},
                       {hex(0x2c313c)},
                       {hex(0x21252e)},
                       {hex(0x767d8c)},
                       {hex(0x4c5362)},
                       {hex(0xe3b341)},
                       {hex(0x3a404d)},
                       {hex(0x5aa9f0), hex(0xff8f4a), hex(0x57c98b), hex(0xcf8ae0), hex(0xe0bd48), hex(0x4fc6d8),
                        hex(0xff7a9c), hex(0xaab0bd)}};

}  // namespace

const PlotTheme& plot_theme(Theme theme) { return theme == Theme::light ? k_light : k_dark; }

}  // namespace grouser
