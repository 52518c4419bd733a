#include "model/camera_view.h"

#include "model/file_json.h"

namespace grouser {

CameraView read_camera_view(const std::filesystem::path& file) {
  CameraView view;
  read_document(file, k_camera_format, [&](ObjectReader& r) {
    view.name = r.text("name");
    view.mount = r.choice<CameraMount>("mount", {{"world", CameraMount::world},
                                                 {"follow", CameraMount::follow},
                                                 {"heading", CameraMount::heading},
                                                 {"chassis", CameraMount::chassis}});
    const std::size_t before = r.findings().size();
    view.eye = r.vector("eye", dimension::length);
    view.target = r.vector("target", dimension::length);
    const bool readable = r.findings().size() == before && r.has_quantity("eye") && r.has_quantity("target");
    if (readable && (view.eye - view.target).norm() < 1e-3)
      r.report(r.key_of("target"), "a place at least 1 mm from the eye", "the eye's own");
    view.height = r.optional_quantity("height", dimension::length, Range::positive);
    const std::optional<double> angle = r.optional_quantity("field_of_view", dimension::angle, Range::positive);
    if (view.height && angle) r.report(r.key_of("height"), "either field_of_view or height", "both");
    if (!view.height && !angle) r.report("", "field_of_view (a perspective) or height (a parallel view)", "neither");
    view.field_of_view = angle.value_or(0.0);
    if (view.field_of_view >= k_pi)
      r.report(r.key_of("field_of_view"), "an angle below 180 deg", shown(*r.raw(r.key_of("field_of_view"))));
  });
  return view;
}

}  // namespace grouser
