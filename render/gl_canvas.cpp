#include "render/gl_canvas.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "render/shaders.h"

namespace grouser {
namespace {

constexpr int k_atlas_size = 1024;

Box intersection(const Box& a, const Box& b) {
  return {std::max(a.left, b.left), std::max(a.top, b.top), std::min(a.right, b.right), std::min(a.bottom, b.bottom)};
}

}  // namespace

GlCanvas::GlCanvas(const GlContext& context, int width, int height) : GlCanvas(context, width, height, own_page_) {
  page_color_ = make_texture(context, GL_RGBA8, width, height);
  own_page_ = GlFramebuffer(context);
  context.gl().NamedFramebufferTexture(own_page_.id(), GL_COLOR_ATTACHMENT0, page_color_.id(), 0);
  require_complete(context, own_page_, "the page");
  begin();
  fill(clip_, {{1.0f, 1.0f, 1.0f}});
}

GlCanvas::GlCanvas(const GlContext& context, int width, int height, const GlFramebuffer& page)
    : context_(context), width_(width), height_(height), page_(&page) {
  context.make_current();
  using namespace shaders;
  programs_.line = make_program(context, "line", {shaders::page(), line_vertex()}, {line_fragment()});
  programs_.band = make_program(context, "band", {shaders::page(), band_vertex()}, {band_fragment()});
  programs_.box = make_program(context, "box", {shaders::page(), box_vertex()}, {box_fragment()});
  programs_.cover = make_program(context, "cover", {cover_vertex()}, {cover_fragment()});
  programs_.glyph = make_program(context, "glyph", {shaders::page(), glyph_vertex()}, {glyph_fragment()});
  coverage_color_ = make_texture(context, GL_R8, width, height);
  coverage_ = GlFramebuffer(context);
  context.gl().NamedFramebufferTexture(coverage_.id(), GL_COLOR_ATTACHMENT0, coverage_color_.id(), 0);
  require_complete(context, coverage_, "line coverage");
  atlas_ = make_texture(context, GL_R8, k_atlas_size, k_atlas_size);
  points_ = GlBuffer(context);
  no_vertices_ = GlVertexArray(context);
  clip_ = {0.0f, 0.0f, static_cast<float>(width), static_cast<float>(height)};
  context.check("setting up a canvas");
}

void GlCanvas::begin() {
  context_.make_current();
  const GlApi& gl = context_.gl();
  gl.Disable(GL_DEPTH_TEST);
  gl.Disable(GL_CULL_FACE);
  gl.Disable(GL_FRAMEBUFFER_SRGB);  // blending in sRGB values: text keeps the weight it has in browsers
  gl.Enable(GL_BLEND);
  gl.Enable(GL_SCISSOR_TEST);
  gl.Viewport(0, 0, width_, height_);
  gl.BindVertexArray(no_vertices_.id());
  unclip();
}

Vector2f GlCanvas::size() const { return {static_cast<float>(width_), static_cast<float>(height_)}; }

void GlCanvas::set_scissor(const Box& box) const {
  const float left = std::floor(box.left), top = std::floor(box.top);
  context_.gl().Scissor(static_cast<GLint>(left), static_cast<GLint>(top),
                        static_cast<GLsizei>(std::max(0.0f, std::ceil(box.right) - left)),
                        static_cast<GLsizei>(std::max(0.0f, std::ceil(box.bottom) - top)));
}

void GlCanvas::clip(const Box& box) {
  clip_ = intersection(box, {0.0f, 0.0f, size().x(), size().y()});
  set_scissor(clip_);
}

void GlCanvas::unclip() { clip({0.0f, 0.0f, size().x(), size().y()}); }

void GlCanvas::onto_page() const {
  const GlApi& gl = context_.gl();
  gl.BindFramebuffer(GL_FRAMEBUFFER, page_->id());
  gl.BlendEquation(GL_FUNC_ADD);
  gl.BlendFuncSeparate(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA, GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
}

void GlCanvas::fill(const Box& box, const Color& color) {
  const GlApi& gl = context_.gl();
  onto_page();
  gl.UseProgram(programs_.box.id());
  gl.Uniform2f(0, size().x(), size().y());
  gl.Uniform4f(1, box.left, box.top, box.right, box.bottom);
  gl.Uniform4f(2, color.rgb[0], color.rgb[1], color.rgb[2], color.alpha);
  gl.DrawArrays(GL_TRIANGLES, 0, 6);
}

void GlCanvas::cover(const Box& reach, const Color& color, const GlProgram& program, GLsizei instances) {
  const GlApi& gl = context_.gl();
  set_scissor(intersection(reach, clip_));
  gl.BindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, points_.id());
  gl.BindFramebuffer(GL_FRAMEBUFFER, coverage_.id());
  gl.ClearColor(0.0f, 0.0f, 0.0f, 0.0f);
  gl.Clear(GL_COLOR_BUFFER_BIT);
  gl.BlendEquation(GL_MAX);
  gl.UseProgram(program.id());
  gl.Uniform2f(0, size().x(), size().y());
  gl.DrawArraysInstanced(GL_TRIANGLES, 0, 6, instances);
  onto_page();
  gl.UseProgram(programs_.cover.id());
  gl.BindTextureUnit(0, coverage_color_.id());
  gl.Uniform4f(2, color.rgb[0], color.rgb[1], color.rgb[2], color.alpha);
  gl.DrawArrays(GL_TRIANGLES, 0, 3);
  set_scissor(clip_);
}

void GlCanvas::draw_capsules(std::span<const Vector2f> points, float width, const Color& color, const Dash& dash,
                             bool joined) {
  if (points.size() < (joined ? 2U : 1U)) return;
  const GlApi& gl = context_.gl();
  std::vector<Eigen::Vector4f> data;
  Box reach{points[0].x(), points[0].y(), points[0].x(), points[0].y()};
  float length = 0.0f;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vector2f& p = points[i];
    if (i > 0) length += (p - points[i - 1]).norm();
    data.emplace_back(p.x(), p.y(), length, 0.0f);
    reach = {std::min(reach.left, p.x()), std::min(reach.top, p.y()), std::max(reach.right, p.x()),
             std::max(reach.bottom, p.y())};
  }
  const float margin = 0.5f * width + 2.0f;
  reach = {reach.left - margin, reach.top - margin, reach.right + margin, reach.bottom + margin};
  gl.NamedBufferData(points_.id(), static_cast<GLsizeiptr>(data.size() * sizeof(data[0])), data.data(), GL_STREAM_DRAW);
  gl.UseProgram(programs_.line.id());
  gl.Uniform1f(1, 0.5f * width);
  gl.Uniform2f(2, dash.drawn, dash.period);
  gl.Uniform1i(3, joined ? 1 : 0);
  cover(reach, color, programs_.line, static_cast<GLsizei>(points.size() - (joined ? 1 : 0)));
}

void GlCanvas::line(std::span<const Vector2f> points, float width, const Color& color, const Dash& dash) {
  draw_capsules(points, width, color, dash, true);
}

void GlCanvas::dots(std::span<const Vector2f> points, float diameter, const Color& color) {
  draw_capsules(points, diameter, color, {}, false);
}

void GlCanvas::band(std::span<const Vector3f> points, const Color& color) {
  if (points.size() < 2) return;
  std::vector<Eigen::Vector4f> data;
  Box reach{points.front().x(), points[0].y(), points.back().x(), points[0].z()};
  for (const Vector3f& p : points) {
    data.emplace_back(p.x(), p.y(), p.z(), 0.0f);
    reach.top = std::min(reach.top, p.y() - 1.0f);
    reach.bottom = std::max(reach.bottom, p.z() + 1.0f);
  }
  context_.gl().NamedBufferData(points_.id(), static_cast<GLsizeiptr>(data.size() * sizeof(data[0])), data.data(),
                                GL_STREAM_DRAW);
  cover(reach, color, programs_.band, static_cast<GLsizei>(points.size() - 1));
}

void GlCanvas::image(const Box& box, const Image& picture) {
  if (picture.width == 0 || picture.height == 0) return;
  const GlApi& gl = context_.gl();
  const GlTexture pixels = make_texture(context_, GL_RGBA8, picture.width, picture.height);
  gl.PixelStorei(GL_UNPACK_ALIGNMENT, 1);
  gl.TextureSubImage2D(pixels.id(), 0, 0, 0, picture.width, picture.height, GL_BGR, GL_UNSIGNED_BYTE,
                       picture.bgr.data());
  const GlFramebuffer source(context_);
  gl.NamedFramebufferTexture(source.id(), GL_COLOR_ATTACHMENT0, pixels.id(), 0);
  require_complete(context_, source, "a picture");
  const auto whole = [](float v) { return static_cast<GLint>(std::lround(v)); };
  gl.BlitNamedFramebuffer(source.id(), page_->id(), 0, 0, picture.width, picture.height, whole(box.left),
                          whole(box.top), whole(box.right), whole(box.bottom), GL_COLOR_BUFFER_BIT, GL_NEAREST);
}

const GlCanvas::Cell& GlCanvas::cell_of(char32_t character, int pixels, bool bold) {
  const auto key = std::make_tuple(character, pixels, bold);
  const auto found = cells_.find(key);
  if (found != cells_.end()) return found->second;
  Cell cell{font_.render(character, pixels, bold), 0, 0};
  const GlyphBitmap& glyph = cell.glyph;
  if (atlas_x_ + glyph.width + 1 > k_atlas_size) {
    atlas_x_ = 1;
    atlas_y_ += atlas_row_ + 1;
    atlas_row_ = 0;
  }
  if (atlas_y_ + glyph.height + 1 > k_atlas_size) {  // full: what was drawn stays drawn, so begin again
    cells_.clear();
    atlas_x_ = atlas_y_ = 1;
    atlas_row_ = 0;
  }
  cell.x = atlas_x_;
  cell.y = atlas_y_;
  atlas_x_ += glyph.width + 1;
  atlas_row_ = std::max(atlas_row_, glyph.height);
  if (!glyph.coverage.empty()) {
    const GlApi& gl = context_.gl();
    gl.PixelStorei(GL_UNPACK_ALIGNMENT, 1);
    gl.TextureSubImage2D(atlas_.id(), 0, cell.x, cell.y, glyph.width, glyph.height, GL_RED, GL_UNSIGNED_BYTE,
                         glyph.coverage.data());
  }
  cell.glyph.coverage.clear();
  return cells_.emplace(key, std::move(cell)).first->second;
}

void GlCanvas::text(const Vector2f& at, const std::string& text, const TextStyle& style) {
  const GlApi& gl = context_.gl();
  const TextLayout layout = lay_out(font_, text, style.size, style.bold);
  const float start = style.align == TextAlign::left     ? 0.0f
                      : style.align == TextAlign::center ? -0.5f * layout.width
                                                         : -layout.width;
  onto_page();
  gl.UseProgram(programs_.glyph.id());
  gl.BindTextureUnit(0, atlas_.id());
  gl.Uniform2f(0, size().x(), size().y());
  gl.Uniform4f(2, style.color.rgb[0], style.color.rgb[1], style.color.rgb[2], style.color.alpha);
  gl.Uniform1i(4, style.upwards ? 1 : 0);
  for (const TextGlyph& glyph : layout.glyphs) {
    const Cell& cell = cell_of(glyph.character, glyph.pixels, style.bold);
    const auto width = static_cast<float>(cell.glyph.width), height = static_cast<float>(cell.glyph.height);
    const float pen = start + glyph.x + static_cast<float>(cell.glyph.left);
    const float rise = glyph.shift - static_cast<float>(cell.glyph.top);
    // Whole pixels: the bitmap is hinted for them.
    if (style.upwards) {
      const float left = std::round(at.x() + rise), top = std::round(at.y() - pen - width);
      gl.Uniform4f(1, left, top, left + height, top + width);
    } else {
      const float left = std::round(at.x() + pen), top = std::round(at.y() + rise);
      gl.Uniform4f(1, left, top, left + width, top + height);
    }
    const auto x = static_cast<float>(cell.x), y = static_cast<float>(cell.y);
    gl.Uniform4f(3, x, y, x + width, y + height);
    if (cell.glyph.width > 0) gl.DrawArrays(GL_TRIANGLES, 0, 6);
  }
}

float GlCanvas::text_width(const std::string& text, float size, bool bold) const {
  return lay_out(font_, text, size, bold).width;
}

Image GlCanvas::read() const {
  context_.check("drawing a figure");
  return read_image(context_, *page_, width_, height_);
}

}  // namespace grouser
