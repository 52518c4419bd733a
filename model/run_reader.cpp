#include <algorithm>
#include <cstdlib>
#include <functional>
#include <numeric>

#include "model/hdf5_handle.h"
#include "model/run.h"

namespace grouser {

struct RunReader::Impl {
  std::filesystem::path path;
  Hdf5Handle file;

  [[nodiscard]] Hdf5Handle open(const std::string& name) const;
};

namespace {

/// A run that was killed, or still runs, is marked as open for writing: such a file is opened as one with a writer.
Hdf5Handle open_file(const std::filesystem::path& path) {
  Hdf5Handle file(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose);
  if (file) return file;
  file = Hdf5Handle(H5Fopen(path.c_str(), H5F_ACC_RDONLY | H5F_ACC_SWMR_READ, H5P_DEFAULT), H5Fclose);
  if (!file) throw FileError("cannot read " + path.string() + ": not a readable HDF5 file");
  return file;
}

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

Hdf5Handle memory_string() {
  Hdf5Handle type(H5Tcopy(H5T_C_S1), H5Tclose);
  H5Tset_size(type.id(), H5T_VARIABLE);
  H5Tset_cset(type.id(), H5T_CSET_UTF8);
  return type;
}

std::string unit_of(hid_t dataset) {
  const Hdf5Handle attribute(H5Aopen(dataset, "unit", H5P_DEFAULT), H5Aclose);
  if (!attribute) return {};
  std::vector<char*> text(1, nullptr);
  const Hdf5Handle type = memory_string();
  if (H5Aread(attribute.id(), type.id(), text.data()) < 0) return {};
  return take_strings(text).front();
}

herr_t collect_dataset(hid_t, const char* name, const H5O_info_t* info, void* names) {
  if (info->type == H5O_TYPE_DATASET) static_cast<std::vector<std::string>*>(names)->emplace_back("/").append(name);
  return 0;
}

}  // namespace

Hdf5Handle RunReader::Impl::open(const std::string& name) const {
  Hdf5Handle set(H5Dopen2(file.id(), name.c_str(), H5P_DEFAULT), H5Dclose);
  if (!set) throw FileError(path.string() + " holds no dataset " + name);
  return set;
}

RunReader::RunReader(const std::filesystem::path& file) : impl_(std::make_unique<Impl>()) {
  silence_hdf5();
  impl_->path = file;
  impl_->file = open_file(file);
}
RunReader::~RunReader() = default;
RunReader::RunReader(RunReader&&) noexcept = default;

bool RunReader::has(const std::string& path) const {
  return static_cast<bool>(Hdf5Handle(H5Dopen2(impl_->file.id(), path.c_str(), H5P_DEFAULT), H5Dclose));
}

std::vector<std::string> RunReader::datasets() const {
  std::vector<std::string> names;
  H5Ovisit2(impl_->file.id(), H5_INDEX_NAME, H5_ITER_INC, collect_dataset, &names, H5O_INFO_BASIC);
  return names;
}

Array RunReader::read(const std::string& path) const {
  const Hdf5Handle set = impl_->open(path);
  const std::vector<hsize_t> shape = shape_of(set.id());
  return read_rows(path, 0, shape.empty() ? 1 : shape[0]);
}

Array RunReader::read_rows(const std::string& path, std::size_t first, std::size_t count) const {
  const Hdf5Handle set = impl_->open(path);
  std::vector<hsize_t> part = shape_of(set.id());
  if (part.empty() || first + count > part[0]) {
    throw FileError(path + " of " + impl_->path.string() + " ends before row " + std::to_string(first + count));
  }
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
  const Hdf5Handle set = impl_->open(path);
  const std::vector<hsize_t> shape = shape_of(set.id());
  bool inside = shape.size() == index.size() + 1;
  for (std::size_t i = 0; inside && i < index.size(); ++i) inside = index[i] < shape[i + 1];
  if (!inside) throw FileError(path + " of " + impl_->path.string() + " has no such column");
  std::vector<double> values(shape[0]);
  if (values.empty()) return values;
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
  const Hdf5Handle set = impl_->open(path);
  const std::vector<hsize_t> shape = shape_of(set.id());
  std::vector<char*> texts(shape.empty() ? 0 : shape[0], nullptr);
  if (texts.empty()) return {};
  const Hdf5Handle type = memory_string();
  if (H5Dread(set.id(), type.id(), H5S_ALL, H5S_ALL, H5P_DEFAULT, texts.data()) < 0) {
    fail_hdf5("read " + path, impl_->path);
  }
  return take_strings(texts);
}

}  // namespace grouser
