#include "model/hdf5_fault.h"

#include <sys/stat.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <exception>
#include <string>
#include <vector>

#include "model/hdf5_handle.h"

namespace grouser {
namespace {

constexpr hsize_t k_most_objects = 100'000, k_most_chunk_bytes = 64u << 20, k_most_texts = 1'000'000;
constexpr hsize_t k_most_row_values = 100'000;
constexpr hsize_t k_most_old_chunks = 10'000;  // each is sought from the first on
constexpr hsize_t k_most_deflated = 1032;      // times; what zlib can make of a byte
/// Values in all that any file may hold, and more for each byte on the disk: a run packs its numbers to a third or so.
constexpr hsize_t k_most_values = 200'000'000, k_most_values_a_byte = 4;
/// Stored bytes in all beyond those on the disk, where a file system packs or has not written them yet.
constexpr hsize_t k_most_in_holes = 64u << 20;

/// What the visits of one file find.
struct Survey {
  hid_t file;
  hsize_t on_disk;  ///< bytes; a file with holes has fewer than its size
  hsize_t objects = 0, values = 0, stored = 0;
  std::string fault{};         ///< empty: none
  std::exception_ptr error{};  ///< of a visit: HDF5 calls it with its lock held, which no exception may pass
};

/// A visit that keeps what it throws.
template <typename Visit>
herr_t kept_error(Survey& survey, const Visit& visit) noexcept {
  try {
    visit();
    return survey.fault.empty() ? 0 : 1;
  } catch (...) {
    survey.error = std::current_exception();
    return -1;
  }
}

/// A link into another file, or by name, leads where nobody looked.
herr_t visit_link(hid_t, const char* name, const H5L_info_t* info, void* data) {
  Survey& survey = *static_cast<Survey*>(data);
  return kept_error(survey, [&] {
    if (++survey.objects > k_most_objects) survey.fault = "more than " + std::to_string(k_most_objects) + " objects";
    if (info->type != H5L_TYPE_HARD) survey.fault = std::string("/") + name + " is a link to another place";
  });
}

bool is_number(hid_t type) { return H5Tequal(type, H5T_IEEE_F64LE) > 0 || H5Tequal(type, H5T_IEEE_F32LE) > 0; }
bool is_text(hid_t type) { return H5Tget_class(type) == H5T_STRING && H5Tis_variable_str(type) > 0; }

constexpr int k_most_dimensions = 4;
struct Shape {
  int rank = 0;
  std::array<hsize_t, k_most_dimensions> length{};
  hsize_t values = 1, row = 1;  ///< in all, and in each of the first dimension
};

/// With a fault where no file could hold it.
Shape shape_of(hid_t space, std::string& fault) {
  Shape shape;
  shape.rank = H5Sget_simple_extent_ndims(space);
  if (shape.rank < 1 || shape.rank > k_most_dimensions) {
    fault = "has " + std::to_string(shape.rank) + " dimensions";
    return {};
  }
  H5Sget_simple_extent_dims(space, shape.length.data(), nullptr);
  for (int i = 0; i < shape.rank; ++i) {
    const hsize_t length = shape.length[static_cast<std::size_t>(i)];
    if (__builtin_mul_overflow(shape.values, length, &shape.values)) fault = "claims more values than can be counted";
    if (i == 0) continue;
    // None of these rows need be there: no rows of any width take no room.
    const bool counted = !__builtin_mul_overflow(shape.row, length, &shape.row);
    if (!counted || shape.row > k_most_row_values) {
      fault = "has rows of more than " + std::to_string(k_most_row_values) + " values";
      return {};
    }
  }
  return shape;
}

/// Bytes of one chunk, and its lengths; 0 where the dataset is not chunked. A fault names what a run never has.
hsize_t chunk_bytes(hid_t creation, hsize_t value_size, int rank, std::array<hsize_t, k_most_dimensions>& chunk,
                    std::string& fault) {
  if (H5Pget_external_count(creation) != 0) fault = "stores its values in another file";
  const H5D_layout_t layout = H5Pget_layout(creation);
  if (layout == H5D_CONTIGUOUS || layout == H5D_COMPACT) return 0;
  if (layout != H5D_CHUNKED || H5Pget_chunk(creation, rank, chunk.data()) != rank) fault = "is no stored dataset";
  hsize_t bytes = value_size;
  for (int i = 0; i < rank && fault.empty(); ++i) {
    if (chunk[static_cast<std::size_t>(i)] == 0) fault = "has chunks without values";
    const bool fits = !__builtin_mul_overflow(bytes, chunk[static_cast<std::size_t>(i)], &bytes);
    if (!fits || bytes > k_most_chunk_bytes)
      fault = "has chunks above " + std::to_string(k_most_chunk_bytes >> 20) + " MB";
  }
  return bytes;
}

struct Filters {
  int count = 0, deflating = 0;
};

Filters filters_of(hid_t creation, std::string& fault) {
  Filters filters{H5Pget_nfilters(creation)};
  for (int i = 0; i < filters.count; ++i) {
    unsigned flags = 0, configuration = 0;
    std::size_t no_values = 0;
    const H5Z_filter_t filter =
        H5Pget_filter2(creation, static_cast<unsigned>(i), &flags, &no_values, nullptr, 0, nullptr, &configuration);
    if (filter == H5Z_FILTER_DEFLATE) ++filters.deflating;
    if (filter != H5Z_FILTER_DEFLATE && filter != H5Z_FILTER_SHUFFLE)
      fault = "passes a filter other than shuffle and gzip";
  }
  if (filters.deflating > 1) fault = "passes gzip more than once";
  return filters;
}

/// A dataset of chunks, all of which its claims say are there.
struct Chunks {
  hid_t set, space;
  std::array<hsize_t, k_most_dimensions> length{};
  hsize_t bytes = 0;  ///< of one
  hsize_t count = 0;
};

/// Without a filter only the index of old files states a size for each chunk. No run has one: HDF5 seeks each from the
/// index's begin.
std::string fault_of_plain_chunks(const Chunks& chunks) {
  const std::string cut = "has chunks that are cut short";
  H5D_chunk_index_t index{};
  if (H5Dget_chunk_index_type(chunks.set, &index) < 0) return cut;
  if (index != H5D_CHUNK_IDX_BTREE) return "";
  if (chunks.count > k_most_old_chunks) {
    return "has more than " + std::to_string(k_most_old_chunks) + " chunks in an index of old files";
  }
  for (hsize_t i = 0; i < chunks.count; ++i) {
    hsize_t size = 0;
    const bool told = H5Dget_chunk_info(chunks.set, chunks.space, i, nullptr, nullptr, nullptr, &size) >= 0;
    if (!told || size != chunks.bytes) return cut;
  }
  return "";
}

/// Whether a chunk, packed as it is stored, is one to the byte. Both buffers are for use again.
bool unpacks_whole(const Chunks& chunks, const hsize_t* offset, bool deflated, std::vector<unsigned char>& packed,
                   std::vector<unsigned char>& plain) {
  hsize_t size = 0;
  std::uint32_t filters_left_out = 0;
  if (H5Dget_chunk_storage_size(chunks.set, offset, &size) < 0 || size > compressBound(chunks.bytes)) return false;
  if (!deflated) return size == chunks.bytes;
  packed.resize(size);
  plain.resize(chunks.bytes);
  uLongf length = plain.size();
  return size > 0 && H5Dread_chunk(chunks.set, H5P_DEFAULT, offset, &filters_left_out, packed.data()) >= 0 &&
         filters_left_out == 0 && uncompress(plain.data(), &length, packed.data(), packed.size()) == Z_OK &&
         length == chunks.bytes;
}

/// Goes to the next chunk, row by row; false behind the last.
bool next_chunk(const Chunks& chunks, const Shape& shape, std::array<hsize_t, k_most_dimensions>& offset) {
  for (auto i = static_cast<std::size_t>(shape.rank); i-- > 0;) {
    offset[i] += chunks.length[i];
    if (offset[i] < shape.length[i]) return true;
    offset[i] = 0;
  }
  return false;
}

/// HDF5 takes whatever a chunk unpacks to for the whole chunk, and reads past the end of what is less.
void survey_chunks(const Chunks& chunks, const Shape& shape, const Filters& filters, std::string& fault) {
  if (filters.count == 0) {
    fault = fault_of_plain_chunks(chunks);
    return;
  }
  std::vector<unsigned char> packed, plain;
  std::array<hsize_t, k_most_dimensions> offset{};
  bool more = shape.values > 0;
  for (; more && fault.empty(); more = next_chunk(chunks, shape, offset)) {
    if (!unpacks_whole(chunks, offset.data(), filters.deflating > 0, packed, plain)) fault = "cannot be unpacked";
  }
}

void read_texts(hid_t set, hid_t space, hsize_t count, std::string& fault) {
  if (count > k_most_texts) {
    fault = "claims " + std::to_string(count) + " texts";
    return;
  }
  std::vector<char*> texts(count, nullptr);
  const Hdf5Handle type = text_in_memory();
  if (count == 0) return;
  if (H5Dread(set, type.id(), H5S_ALL, H5S_ALL, H5P_DEFAULT, texts.data()) < 0) fault = "has texts that cannot be read";
  H5Dvlen_reclaim(type.id(), space, H5P_DEFAULT, texts.data());
}

/// Bytes of a text in its dataset: its length, and where it lies among those of all.
hsize_t text_size(hid_t file) {
  const Hdf5Handle creation(H5Fget_create_plist(file), H5Pclose);
  std::size_t address = 0, length = 0;
  H5Pget_sizes(creation.id(), &address, &length);
  constexpr hsize_t k_length = 4, k_place = 4;
  return k_length + address + k_place;
}

void survey_unit(hid_t set, std::string& fault) {
  if (H5Aget_num_attrs(set) == 0) return;
  const Hdf5Handle unit(H5Aopen(set, "unit", H5P_DEFAULT), H5Aclose),
      space(unit ? H5Aget_space(unit.id()) : -1, H5Sclose);
  const Hdf5Handle stored(unit ? H5Aget_type(unit.id()) : -1, H5Tclose), type = text_in_memory();
  char* text = nullptr;
  if (!unit || !is_text(stored.id()) || H5Sget_simple_extent_type(space.id()) != H5S_SCALAR ||
      H5Aread(unit.id(), type.id(), &text) < 0) {
    fault = "has a unit that is no text";
  }
  H5free_memory(text);
}

/// Adds a dataset to what the file claims in all: holes, chunks at one address and packed zeros cost no disk.
void add_claim(Survey& survey, hsize_t values, hsize_t stored, std::string& fault) {
  const std::string disk = std::to_string(survey.on_disk) + " bytes on the disk";
  const hsize_t most_values = k_most_values + k_most_values_a_byte * survey.on_disk;
  const hsize_t most_stored = k_most_in_holes + survey.on_disk;
  if (__builtin_add_overflow(survey.values, values, &survey.values) || survey.values > most_values) {
    fault = "claims " + std::to_string(values) + " values: expected at most " + std::to_string(most_values) +
            " in all in a file of " + disk + ", found more";
  } else if (__builtin_add_overflow(survey.stored, stored, &survey.stored) || survey.stored > most_stored) {
    fault = "claims " + std::to_string(stored) + " stored bytes: expected at most " + std::to_string(most_stored) +
            " in all in a file of " + disk + ", found holes or parts that are shared";
  }
}

void survey_dataset(hid_t set, Survey& survey, std::string& fault) {
  const Hdf5Handle type(H5Dget_type(set), H5Tclose), space(H5Dget_space(set), H5Sclose);
  const Hdf5Handle creation(H5Dget_create_plist(set), H5Pclose);
  if (!type || !space || !creation) {
    fault = "cannot be opened";
    return;
  }
  const bool texts = is_text(type.id());
  if (!texts && !is_number(type.id())) fault = "holds neither 32- or 64-bit numbers nor texts";
  const Shape shape = shape_of(space.id(), fault);
  const hsize_t count = shape.values, value_size = texts ? text_size(survey.file) : H5Tget_size(type.id());
  if (!fault.empty()) return;
  Chunks chunks{set, space.id()};
  chunks.bytes = chunk_bytes(creation.id(), value_size, shape.rank, chunks.length, fault);
  const Filters filters = filters_of(creation.id(), fault);
  if (fault.empty() && chunks.bytes > 0 && H5Dget_num_chunks(set, space.id(), &chunks.count) < 0)
    fault = "has an index that cannot be read";
  const hsize_t stored = H5Dget_storage_size(set);
  if (fault.empty() && (count / (filters.deflating > 0 ? k_most_deflated : 1) > stored / value_size ||
                        (chunks.bytes > 0 && count > chunks.count * (chunks.bytes / value_size)))) {
    fault = "claims " + std::to_string(count) + " values, of which " + std::to_string(stored) + " bytes are stored";
  }
  if (fault.empty()) add_claim(survey, std::max(count, shape.row), stored, fault);
  if (fault.empty() && chunks.bytes > 0) survey_chunks(chunks, shape, filters, fault);
  if (!fault.empty()) return;
  survey_unit(set, fault);
  if (texts) read_texts(set, space.id(), count, fault);
}

void survey_object(hid_t file, const char* name, const H5O_info_t* info, Survey& survey) {
  std::string fault;
  if (info->type == H5O_TYPE_DATASET) {
    const Hdf5Handle set(H5Dopen2(file, name, H5P_DEFAULT), H5Dclose);
    if (set) survey_dataset(set.id(), survey, fault);
    if (!set) fault = "cannot be opened";
  } else if (info->type != H5O_TYPE_GROUP) {
    fault = "is neither a group nor a dataset";
  }
  if (!fault.empty()) survey.fault = std::string("/") + name + " " + fault;
}

herr_t visit_object(hid_t file, const char* name, const H5O_info_t* info, void* data) {
  Survey& survey = *static_cast<Survey*>(data);
  return kept_error(survey, [&] { survey_object(file, name, info, survey); });
}

}  // namespace

std::string fault_of_hdf5(const std::filesystem::path& path) {
  silence_hdf5();
  const Hdf5Handle file = open_hdf5(path);
  if (!file) return "no HDF5 file, or one that is cut short or damaged";
  struct stat status = {};
  if (::stat(path.c_str(), &status) != 0) return std::strerror(errno);
  constexpr hsize_t k_block = 512;  // bytes, whatever the file system's own
  Survey survey{file.id(), k_block * static_cast<hsize_t>(status.st_blocks)};
  const bool links = H5Lvisit(file.id(), H5_INDEX_NAME, H5_ITER_INC, visit_link, &survey) >= 0;
  const bool objects = links && survey.fault.empty() &&
                       H5Ovisit2(file.id(), H5_INDEX_NAME, H5_ITER_INC, visit_object, &survey, H5O_INFO_BASIC) >= 0;
  if (survey.error) std::rethrow_exception(survey.error);
  if (survey.fault.empty() && !objects) return "a damaged HDF5 file";
  return survey.fault;
}

}  // namespace grouser
