#pragma once
#include "render/canvas.h"

namespace grouser {

/// Draws a figure over the whole canvas, `scale` device pixels a CSS pixel. Throws InputError when the x and y (or the
/// edges of a band) differ in length.
void draw_on(Canvas& canvas, const Figure& figure, Theme theme, float scale);

}  // namespace grouser
