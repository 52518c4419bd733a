#pragma once
#include <nlohmann/json.hpp>
#include <string>

#include "render/figure.h"
#include "reports/twin.h"

/// A figure as a block of a page: caption and text alternative, drawn pictures, and the data of its interactive chart.
namespace grouser {

/// True when the panels stand one under the other and every series runs forward in x, so that charts over x can show
/// them. A map can be one.
[[nodiscard]] bool chartable(const Figure& figure);

/// Indices of the rows that show a set of curves on `max_rows` rows: the lowest and the highest sample of every curve
/// in each of equal stretches of rows, and both ends. All rows when they are few enough.
[[nodiscard]] std::vector<std::size_t> peak_preserving_rows(const std::vector<const std::vector<double>*>& curves,
                                                            std::size_t max_rows);

/// One sentence for those who cannot see the picture: what is plotted over what, and the range of each curve.
[[nodiscard]] std::string text_alternative(const Figure& figure);

/// The block: {id, name, title, caption, alt, chart, drawn, tiled, data, payload_svg, ...}. `id` is unique on the page.
/// `data` holds the numbers that the page shows. A figure that cannot be a chart becomes small multiples: tiles[] of
/// {title, note, data, payload_svg}, whose `note` the caller may fill with a line to stand under the tile, and a
/// legend[] for all of them, or one each where their colours mean different things.
[[nodiscard]] nlohmann::json figure_block(const Figure& figure, const std::string& id);

}  // namespace grouser
