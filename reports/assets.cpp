#include "reports/assets.h"

#include <array>
#include <kainjow/mustache.hpp>
#include <stdexcept>

#include "model/provenance.h"
#include "model/utf8.h"
#include "render/base64.h"
#include "reports/twin.h"

#define GROUSER_ASSET(symbol) extern "C" const char symbol##_begin[], symbol##_end[]
GROUSER_ASSET(asset_report_mustache);
GROUSER_ASSET(asset_run_mustache);
GROUSER_ASSET(asset_against_mustache);
GROUSER_ASSET(asset_ratings_mustache);
GROUSER_ASSET(asset_study_mustache);
GROUSER_ASSET(asset_comparison_mustache);
GROUSER_ASSET(asset_fit_mustache);
GROUSER_ASSET(asset_fit_comparison_mustache);
GROUSER_ASSET(asset_rig_mustache);
GROUSER_ASSET(asset_checks_mustache);
GROUSER_ASSET(asset_notes_mustache);
GROUSER_ASSET(asset_tests_mustache);
GROUSER_ASSET(asset_figure_mustache);
GROUSER_ASSET(asset_provenance_mustache);
GROUSER_ASSET(asset_index_mustache);
GROUSER_ASSET(asset_page_css);
GROUSER_ASSET(asset_page_js);
GROUSER_ASSET(asset_charts_js);
GROUSER_ASSET(asset_player_js);
GROUSER_ASSET(asset_uplot_js);
GROUSER_ASSET(asset_uplot_css);
#undef GROUSER_ASSET

namespace grouser {
namespace {

using kainjow::mustache::data;
using kainjow::mustache::mustache;

struct Template {
  std::string_view name;
  const char* begin;
  const char* end;
};
const std::array<Template, 15> k_templates{{
    {"report", asset_report_mustache_begin, asset_report_mustache_end},
    {"run", asset_run_mustache_begin, asset_run_mustache_end},
    {"against", asset_against_mustache_begin, asset_against_mustache_end},
    {"ratings", asset_ratings_mustache_begin, asset_ratings_mustache_end},
    {"study", asset_study_mustache_begin, asset_study_mustache_end},
    {"comparison", asset_comparison_mustache_begin, asset_comparison_mustache_end},
    {"fit", asset_fit_mustache_begin, asset_fit_mustache_end},
    {"fit_comparison", asset_fit_comparison_mustache_begin, asset_fit_comparison_mustache_end},
    {"rig", asset_rig_mustache_begin, asset_rig_mustache_end},
    {"checks", asset_checks_mustache_begin, asset_checks_mustache_end},
    {"notes", asset_notes_mustache_begin, asset_notes_mustache_end},
    {"tests", asset_tests_mustache_begin, asset_tests_mustache_end},
    {"figure", asset_figure_mustache_begin, asset_figure_mustache_end},
    {"provenance", asset_provenance_mustache_begin, asset_provenance_mustache_end},
    {"index", asset_index_mustache_begin, asset_index_mustache_end},
}};

std::string template_text(std::string_view name) {
  for (const Template& entry : k_templates)
    if (entry.name == name) return {entry.begin, entry.end};
  throw std::logic_error("no page template is called " + std::string(name));
}

data to_mustache(const nlohmann::json& value) {
  switch (value.type()) {
    case nlohmann::json::value_t::object: {
      data object{data::type::object};
      for (const auto& [key, item] : value.items())
        if (key != k_data_key) object.set(key, to_mustache(item));
      return object;
    }
    case nlohmann::json::value_t::array: {
      data list{data::type::list};
      for (const nlohmann::json& item : value) list.push_back(to_mustache(item));
      return list;
    }
    case nlohmann::json::value_t::boolean:
      return data(value.get<bool>() ? data::type::bool_true : data::type::bool_false);
    case nlohmann::json::value_t::string:
      // A section over an empty text is left out, as mustache does with an empty list.
      return value.get_ref<const std::string&>().empty() ? data(data::type::bool_false)
                                                         : data(value.get<std::string>());
    case nlohmann::json::value_t::null:
    case nlohmann::json::value_t::discarded:
      return data(data::type::bool_false);
    default:
      return data(value.dump());
  }
}

/// A script as a Content-Security-Policy names it.
std::string source_of(const std::string& script) {
  const std::string hex = sha256_of(script);
  std::string digest;
  for (std::size_t i = 0; i < hex.size(); i += 2) digest += static_cast<char>(std::stoi(hex.substr(i, 2), nullptr, 16));
  return "'sha256-" + base64(digest) + "'";
}

}  // namespace

bool has_interactive_charts() {
  // By content: the addresses of two symbols may be taken by the compiler to differ, even where nothing lies between
  // them.
  return std::string(asset_uplot_js_begin, asset_uplot_js_end).find("var uPlot=") != std::string::npos;
}

std::string render_page(std::string_view page, const nlohmann::json& facts) {
  data values = to_mustache(facts);
  for (const Template& entry : k_templates)
    values.set("partial_" + std::string(entry.name),
               data(kainjow::mustache::partial([name = entry.name] { return template_text(name); })));
  const std::string script =
      std::string(asset_page_js_begin, asset_page_js_end) + std::string(asset_player_js_begin, asset_player_js_end);
  const std::string chart_script = has_interactive_charts()
                                       ? std::string(asset_uplot_js_begin, asset_uplot_js_end) +
                                             std::string(asset_charts_js_begin, asset_charts_js_end)
                                       : std::string();
  values.set("style", std::string(asset_page_css_begin, asset_page_css_end));
  values.set("script", script);
  values.set("chart_style", std::string(asset_uplot_css_begin, asset_uplot_css_end));
  values.set("chart_script", chart_script);
  // These two scripts run and no other; nothing is loaded from anywhere, whatever a name in the data may hold.
  values.set("policy", "default-src 'none'; script-src " + source_of(chart_script) + " " + source_of(script) +
                           "; style-src 'unsafe-inline'; img-src data:; media-src data:; base-uri 'none'; "
                           "form-action 'none'");
  mustache text(template_text(page));
  std::string html = text.render(values);
  if (!text.is_valid()) throw std::logic_error("page template " + std::string(page) + ": " + text.error_message());
  return to_utf8(html);
}

}  // namespace grouser
