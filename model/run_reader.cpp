#include <algorithm>
#include <cstdlib>
#include <exception>
#include <functional>
#include <map>
#include <numeric>

#include "model/hdf5_handle.h"
#include "model/hdf5_survey.h"
#include "model/input_file.h"
#include "model/run.h"

namespace grouser {

struct RunReader::Impl {
  using Shape = std::vector<hsize_t>;
  std::filesystem::path path;
  Hdf5Handle file;
  std::map<std::string, Shape> shapes;  ///< of every dataset, its rows cut to those that all of its table have

  [[nodiscard]] const Shape& shape_of(const std::string& name) const;
  [[nodiscard]] Hdf5Handle open(const std::string& name) const;
  void cut_to_common_rows();
};

namespace {

std::vector<hsize_t> shape_of(hid_t dataset) {
  const Hdf5Handle space(H5Dget_space(dataset), H5Sclose);
  std::vector<hsize_t> shape(static_cast<std::size_t>(std::max(H5Sget_simple_extent_ndims(space.id()), 0)));
  H5Sget_simple_extent_dims(space.id(), shape.data(), nullptr);
  return shape;
}

/// Variable-length strings of an attribute or dataset, freed once copied.
std::vector<std::string> take_strings(std::vector<char*>& texts) {
  std::vector<std::string> strings;
  for (char* text : texts) {
    strings.emplace_back(text != nullptr ? text : "");
    H5free_memory(text);
  }
  return strings;
}

std::string unit_of(hid_t dataset) {
  const Hdf5Handle attribute(H5Aopen(dataset, "unit", H5P_DEFAULT), H5Aclose);
  if (!attribute) return {};
  std::vector<char*> text(1, nullptr);
  const Hdf5Handle type = text_in_memory();
  if (H5Aread(attribute.id(), type.id(), text.data()) < 0) return {};
  return take_strings(text).front();
}

/// The table of a dataset, by its group; texts have none.
std::string table_of(const std::string& name) {
  if (name.ends_with("names")) return name;
  for (const char* group : {"/steps/", "/probes/"})
    if (name.starts_with(group)) return group;
  return "/";
}

/// What a visit finds. No exception leaves it, for HDF5 calls it with its lock held: it is kept.
struct Datasets {
  std::map<std::string, std::vector<hsize_t>> shapes;
  std::exception_ptr error;
};

herr_t collect_dataset(hid_t file, const char* name, const H5O_info_t* info, void* data) noexcept {
  Datasets& found = *static_cast<Datasets*>(data);
  try {
    if (info->type != H5O_TYPE_DATASET) return 0;
    const Hdf5Handle set(H5Dopen2(file, name, H5P_DEFAULT), H5Dclose);
    if (!set) return -1;
    found.shapes[std::string("/") + name] = shape_of(set.id());
    return 0;
  } catch (...) {
    found.error = std::current_exception();
    return -1;
  }
}

}  // namespace

const RunReader::Impl::Shape& RunReader::Impl::shape_of(const std::string& name) const {
  const auto found = shapes.find(name);
  if (found == shapes.end()) throw FileError(path.string() + " holds no dataset " + name);
  return found->second;
}

Hdf5Handle RunReader::Impl::open(const std::string& name) const {
  return checked({H5Dopen2(file.id(), name.c_str(), H5P_DEFAULT), H5Dclose}, "open " + name, path);
}

/// A kill between two writes leaves some datasets a chunk longer than others.
void RunReader::Impl::cut_to_common_rows() {
  std::map<std::string, hsize_t> rows;
  for (const auto& [name, shape] : shapes) {
    const auto [table, is_new] = rows.emplace(table_of(name), shape.front());
    table->second = std::min(table->second, shape.front());
  }
  for (auto& [name, shape] : shapes) shape.front() = rows.at(table_of(name));
}

RunReader::RunReader(const std::filesystem::path& file) : impl_(std::make_unique<Impl>()) {
  require_plain_file(file);
  survey_hdf5(file);
  silence_hdf5();
  impl_->path = file;
  impl_->file = open_hdf5(file);
  const std::string refusal = "cannot read " + file.string() + ": ", damaged = "not a readable HDF5 file";
  if (!impl_->file) throw FileError(refusal + why_not_opened(file, damaged));
  // In the file's own order: sorted, HDF5 1.10 frees a list of links that a failed read has left unfilled.
  Datasets found;
  const bool visited =
      H5Ovisit2(impl_->file.id(), H5_INDEX_NAME, H5_ITER_NATIVE, collect_dataset, &found, H5O_INFO_BASIC) >= 0;
  if (found.error) std::rethrow_exception(found.error);
  if (!visited) throw FileError(refusal + damaged);
  impl_->shapes = std::move(found.shapes);
  impl_->cut_to_common_rows();
}
RunReader::~RunReader() = default;
RunReader::RunReader(RunReader&&) noexcept = default;

bool RunReader::has(const std::string& path) const { return impl_->shapes.contains(path); }

std::vector<std::string> RunReader::datasets() const {
  std::vector<std::string> names;
  for (const auto& [name, shape] : impl_->shapes) names.push_back(name);
  return names;
}

Array RunReader::read(const std::string& path) const { return read_rows(path, 0, impl_->shape_of(path).front()); }

Array RunReader::read_rows(const std::string& path, std::size_t first, std::size_t count) const {
  std::vector<hsize_t> part = impl_->shape_of(path);
  if (first + count > part[0]) {
    throw FileError(path + " of " + impl_->path.string() + " ends before row " + std::to_string(first + count));
  }
  const Hdf5Handle set = impl_->open(path);
  part[0] = count;
  std::vector<hsize_t> start(part.size(), 0);
  start[0] = first;
  Array array;
  array.unit = unit_of(set.id());
  array.shape.assign(part.begin(), part.end());
  array.values.resize(std::accumulate(part.begin(), part.end(), std::size_t{1}, std::multiplies<>()));
  if (array.values.empty()) return array;
  const Hdf5Handle space(H5Dget_space(set.id()), H5Sclose);
  const Hdf5Handle memory(H5Screate_simple(static_cast<int>(part.size()), part.data(), nullptr), H5Sclose);
  H5Sselect_hyperslab(space.id(), H5S_SELECT_SET, start.data(), nullptr, part.data(), nullptr);
  if (H5Dread(set.id(), H5T_NATIVE_DOUBLE, memory.id(), space.id(), H5P_DEFAULT, array.values.data()) < 0) {
    fail_hdf5("read " + path, impl_->path);
  }
  return array;
}

std::vector<double> RunReader::read_column(const std::string& path, const std::vector<std::size_t>& index) const {
  const std::vector<hsize_t>& shape = impl_->shape_of(path);
  bool inside = shape.size() == index.size() + 1;
  for (std::size_t i = 0; inside && i < index.size(); ++i) inside = index[i] < shape[i + 1];
  if (!inside) throw FileError(path + " of " + impl_->path.string() + " has no such column");
  std::vector<double> values(shape[0]);
  if (values.empty()) return values;
  const Hdf5Handle set = impl_->open(path);
  std::vector<hsize_t> start(shape.size(), 0), part(shape.size(), 1);
  std::copy(index.begin(), index.end(), start.begin() + 1);
  part[0] = shape[0];
  const Hdf5Handle space(H5Dget_space(set.id()), H5Sclose), memory(H5Screate_simple(1, part.data(), nullptr), H5Sclose);
  H5Sselect_hyperslab(space.id(), H5S_SELECT_SET, start.data(), nullptr, part.data(), nullptr);
  if (H5Dread(set.id(), H5T_NATIVE_DOUBLE, memory.id(), space.id(), H5P_DEFAULT, values.data()) < 0) {
    fail_hdf5("read " + path, impl_->path);
  }
  return values;
}

std::vector<std::string> RunReader::read_names(const std::string& path) const {
  const std::vector<hsize_t>& shape = impl_->shape_of(path);
  const Hdf5Handle set = impl_->open(path);
  const Hdf5Handle stored(H5Dget_type(set.id()), H5Tclose);
  if (shape.size() != 1 || H5Tget_class(stored.id()) != H5T_STRING) {
    throw FileError(path + " of " + impl_->path.string() + " holds no list of texts");
  }
  std::vector<char*> texts(shape[0], nullptr);
  if (texts.empty()) return {};
  const Hdf5Handle type = text_in_memory();
  if (H5Dread(set.id(), type.id(), H5S_ALL, H5S_ALL, H5P_DEFAULT, texts.data()) < 0) {
    fail_hdf5("read " + path, impl_->path);
  }
  return take_strings(texts);
}

}  // namespace grouser
