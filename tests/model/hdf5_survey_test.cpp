#include "model/hdf5_survey.h"

#include <gmock/gmock.h>
#include <hdf5.h>

#include <array>
#include <csignal>

#include "model/errors.h"
#include "model/hdf5_handle.h"
#include "tests/support/test_data.h"

namespace grouser {
namespace {

using ::testing::HasSubstr;
using ::testing::MatchesRegex;

/// A file with one dataset of the given type and rows, in chunks.
std::filesystem::path file_with(const TemporaryFolder& folder, hid_t type, hsize_t rows, hsize_t chunk_rows) {
  const std::filesystem::path path = folder / "run.h5";
  const Hdf5Handle file(H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT), H5Fclose);
  const Hdf5Handle space(H5Screate_simple(1, &rows, nullptr), H5Sclose);
  const Hdf5Handle creation(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  H5Pset_chunk(creation.id(), 1, &chunk_rows);
  const Hdf5Handle set(H5Dcreate2(file.id(), "time", type, space.id(), H5P_DEFAULT, creation.id(), H5P_DEFAULT),
                       H5Dclose);
  const std::vector<double> values(rows < 1000 ? rows : 0, 1.0);
  if (!values.empty()) H5Dwrite(set.id(), H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
  return path;
}

/// A file with datasets whose room is taken and never written: holes, of any size.
std::filesystem::path file_with_holes(const TemporaryFolder& folder, int sets, hsize_t rows) {
  const std::filesystem::path path = folder / "run.h5";
  const Hdf5Handle file(H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT), H5Fclose);
  const Hdf5Handle space(H5Screate_simple(1, &rows, nullptr), H5Sclose);
  const Hdf5Handle creation(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  H5Pset_alloc_time(creation.id(), H5D_ALLOC_TIME_EARLY);
  H5Pset_fill_time(creation.id(), H5D_FILL_TIME_NEVER);
  for (int i = 0; i < sets; ++i) {
    const std::string name = "set" + std::to_string(i);
    const Hdf5Handle set(
        H5Dcreate2(file.id(), name.c_str(), H5T_IEEE_F64LE, space.id(), H5P_DEFAULT, creation.id(), H5P_DEFAULT),
        H5Dclose);
  }
  return path;
}

/// The words of the refusal behind the file's name; empty where there is none.
std::string refusal_of(const std::filesystem::path& file) {
  try {
    survey_hdf5(file);
  } catch (const FileError& error) {
    const std::string text = error.what();
    return text.substr(text.find(": ") + 2);
  }
  return "";
}

TEST(Hdf5Survey, LetsNothingThroughWhereItCannotLearnHowItsProcessEnded) {
  const TemporaryFolder folder;
  const auto before = std::signal(SIGCHLD, SIG_IGN);  // the system then forgets it
  const std::string refusal = refusal_of(file_with(folder, H5T_IEEE_F64LE, 100, 16));
  std::signal(SIGCHLD, before);
  EXPECT_THAT(refusal, HasSubstr("the process that looks at it first"));
}

TEST(Hdf5Survey, LetsPlainNumbersThrough) {
  const TemporaryFolder folder;
  EXPECT_EQ(refusal_of(file_with(folder, H5T_IEEE_F64LE, 100, 16)), "");
}

TEST(Hdf5Survey, LetsTextsInPackedChunksThrough) {
  const TemporaryFolder folder;
  const std::filesystem::path path = folder / "run.h5";
  const hsize_t count = 3, chunk = 2;
  const std::array<const char*, 3> texts{"left/sprocket", "", "right/idler"};
  {
    const Hdf5Handle file(H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT), H5Fclose);
    const Hdf5Handle space(H5Screate_simple(1, &count, nullptr), H5Sclose), type = text_in_memory();
    const Hdf5Handle creation(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
    H5Pset_chunk(creation.id(), 1, &chunk);
    H5Pset_deflate(creation.id(), 1);
    const Hdf5Handle set(H5Dcreate2(file.id(), "names", type.id(), space.id(), H5P_DEFAULT, creation.id(), H5P_DEFAULT),
                         H5Dclose);
    H5Dwrite(set.id(), type.id(), H5S_ALL, H5S_ALL, H5P_DEFAULT, texts.data());
  }
  EXPECT_EQ(refusal_of(path), "");
}

TEST(Hdf5Survey, SaysWhyAFileCannotBeOpened) {
  const TemporaryFolder folder;
  EXPECT_EQ(refusal_of(folder / "nothing.h5"), "No such file or directory");
}

TEST(Hdf5Survey, RefusesRowsThatAreOnlyClaimed) {
  const TemporaryFolder folder;
  EXPECT_EQ(refusal_of(file_with(folder, H5T_IEEE_F64LE, 1'000'000'000, 1024)),
            "/time claims 1000000000 values, of which 0 bytes are stored");
}

TEST(Hdf5Survey, RefusesRowsInHoles) {
  const TemporaryFolder folder;
  EXPECT_THAT(
      refusal_of(file_with_holes(folder, 1, 400'000'000)),
      MatchesRegex("/set0 claims 400000000 values: expected at most 2000[0-9]* in all in a file of [0-9]* bytes on the "
                   "disk, found more"));
  EXPECT_THAT(
      refusal_of(file_with_holes(folder, 1, 10'000'000)),
      MatchesRegex(
          "/set0 claims 80000000 stored bytes: expected at most [0-9]* in all in a file of [0-9]* bytes on the disk, "
          "found holes or parts that are shared"));
}

TEST(Hdf5Survey, RefusesWhatIsTooMuchInAll) {
  const TemporaryFolder folder;
  EXPECT_EQ(refusal_of(file_with_holes(folder, 8, 1'000'000)), "");
  EXPECT_THAT(refusal_of(file_with_holes(folder, 9, 1'000'000)), HasSubstr("/set8 claims 8000000 stored bytes"));
}

TEST(Hdf5Survey, RefusesChunksThatNoRunHas) {
  const TemporaryFolder folder;
  EXPECT_EQ(refusal_of(file_with(folder, H5T_IEEE_F64LE, 1'000'000'000, 100'000'000)), "/time has chunks above 64 MB");
}

TEST(Hdf5Survey, RefusesOtherTypes) {
  const TemporaryFolder folder;
  EXPECT_EQ(refusal_of(file_with(folder, H5T_STD_I64LE, 100, 16)),
            "/time holds neither 32- or 64-bit numbers nor texts");
}

TEST(Hdf5Survey, RefusesLinksIntoOtherFiles) {
  const TemporaryFolder folder;
  const std::filesystem::path path = file_with(folder, H5T_IEEE_F64LE, 100, 16);
  {
    const Hdf5Handle file(H5Fopen(path.c_str(), H5F_ACC_RDWR, H5P_DEFAULT), H5Fclose);
    H5Lcreate_external("/etc/passwd", "/", file.id(), "other", H5P_DEFAULT, H5P_DEFAULT);
  }
  EXPECT_EQ(refusal_of(path), "/other is a link to another place");
}

TEST(Hdf5Survey, RefusesWhatIsNoHdf5) {
  const TemporaryFolder folder;
  EXPECT_EQ(refusal_of(folder.write("run.h5", "text")), "no HDF5 file, or one that is cut short or damaged");
}

}  // namespace
}  // namespace grouser
