// HDF5 files as the library writes them, MATLAB's kind among them, that lead out of themselves or claim what they do
// not hold.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <hdf5.h>

#include <atomic>
#include <fstream>
#include <limits>
#include <map>
#include <thread>

#include "core/message_of.hpp"
#include "core/temporary_folder.hpp"
#include "mottle/core/error.hpp"
#include "mottle/core/files.hpp"
#include "mottle/formats/matrices/mat.hpp"
#include "mottle/formats/matrices/matrix_file.hpp"

namespace mottle::formats {
namespace {

using test::message_of;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

class HostileHdf5 : public ::testing::Test {
 protected:
  hid_t create(const std::string& name, hsize_t user_block = 0) {
    const hid_t creation = H5Pcreate(H5P_FILE_CREATE);
    H5Pset_userblock(creation, user_block);
    const hid_t file = H5Fcreate((folder_ / name).c_str(), H5F_ACC_TRUNC, creation, H5P_DEFAULT);
    H5Pclose(creation);
    return file;
  }
  std::string message_for(const std::string& name) {
    return message_of<InvalidInput>([&] { read_symmetric_matrix((folder_ / name).string() + "#K"); });
  }
  /// A square dataset K of which the first entry alone is written.
  void write_square(const std::string& name, hsize_t size, hid_t creation) {
    const hid_t file = create(name);
    const hsize_t sizes[] = {size, size};
    const hsize_t one[] = {1, 1};
    const hsize_t first[] = {0, 0};
    const hid_t space = H5Screate_simple(2, sizes, nullptr);
    const hid_t memory = H5Screate_simple(2, one, nullptr);
    const hid_t set = H5Dcreate2(file, "K", H5T_NATIVE_DOUBLE, space, H5P_DEFAULT, creation, H5P_DEFAULT);
    const double value = 2.0;
    H5Sselect_hyperslab(space, H5S_SELECT_SET, first, nullptr, one, nullptr);
    H5Dwrite(set, H5T_NATIVE_DOUBLE, memory, space, H5P_DEFAULT, &value);
    H5Dclose(set);
    H5Sclose(memory);
    H5Sclose(space);
    H5Pclose(creation);
    H5Fclose(file);
  }
  /// A group K with vectors of whole numbers, as SciPy lays out sparse matrices.
  void write_vectors(const std::string& name, const std::map<std::string, std::vector<long long>>& vectors) {
    const hid_t file = create(name);
    const hid_t group = H5Gcreate2(file, "K", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
    for (const auto& [vector, numbers] : vectors) {
      const hsize_t size = numbers.size();
      const hid_t space = H5Screate_simple(1, &size, nullptr);
      const hid_t set =
          H5Dcreate2(group, vector.c_str(), H5T_NATIVE_LLONG, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
      H5Dwrite(set, H5T_NATIVE_LLONG, H5S_ALL, H5S_ALL, H5P_DEFAULT, numbers.data());
      H5Dclose(set);
      H5Sclose(space);
    }
    H5Gclose(group);
    H5Fclose(file);
  }
  static hid_t packed_chunks(hsize_t size) {
    const hid_t creation = H5Pcreate(H5P_DATASET_CREATE);
    const hsize_t chunk[] = {size, size};
    H5Pset_chunk(creation, 2, chunk);
    H5Pset_deflate(creation, 9);
    return creation;
  }

  test::TemporaryFolder folder_;
};

TEST_F(HostileHdf5, TwoThreadsReadEachItsOwnFile) {
  write_square("a.h5", 2, H5Pcreate(H5P_DATASET_CREATE));
  write_square("b.h5", 3, H5Pcreate(H5P_DATASET_CREATE));
  std::atomic<int> wrong = 0;
  const auto read = [&](const std::string& name, Eigen::Index size) {
    for (int k = 0; k < 200; ++k) {
      if (read_symmetric_matrix((folder_ / name).string() + "#K").lower.rows() != size) ++wrong;
    }
  };
  {
    const std::jthread other([&] { read("b.h5", 3); });
    read("a.h5", 2);
  }
  EXPECT_EQ(wrong, 0);
}

TEST_F(HostileHdf5, ExternalLinksAreNotFollowed) {
  write_square("dense.h5", 1, H5Pcreate(H5P_DATASET_CREATE));
  const hid_t file = create("link.h5");
  H5Lcreate_external((folder_ / "dense.h5").c_str(), "/K", file, "K", H5P_DEFAULT, H5P_DEFAULT);
  H5Fclose(file);
  EXPECT_THAT(message_for("link.h5"), AllOf(HasSubstr("link.h5: "), HasSubstr("dense.h5"), HasSubstr("copy it in")));
  EXPECT_EQ(read_symmetric_matrix((folder_ / "dense.h5").string()).lower.coeff(0, 0), 2.0);
}

TEST_F(HostileHdf5, ExternalGroupsAndSoftLinksToThemAreNotFollowed) {
  const hid_t other = create("other.h5");
  H5Gclose(H5Gcreate2(other, "G", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
  H5Fclose(other);
  const hid_t file = create("group.h5");
  H5Lcreate_external((folder_ / "other.h5").c_str(), "/G", file, "X", H5P_DEFAULT, H5P_DEFAULT);
  H5Lcreate_soft("/X", file, "K", H5P_DEFAULT, H5P_DEFAULT);
  H5Fclose(file);
  EXPECT_THAT(message_for("group.h5"), HasSubstr("other.h5"));
}

TEST_F(HostileHdf5, LinksInACircleEnd) {
  const hid_t file = create("circle.h5");
  H5Lcreate_soft("/L", file, "K", H5P_DEFAULT, H5P_DEFAULT);
  H5Lcreate_soft("/K", file, "L", H5P_DEFAULT, H5P_DEFAULT);
  H5Fclose(file);
  EXPECT_THAT(message_for("circle.h5"), HasSubstr("'/K' is not a dataset"));
}

TEST_F(HostileHdf5, NumbersInOtherFilesAreNotRead) {
  std::ofstream(folder_ / "secret") << std::string(64, 'x');
  const hid_t external = H5Pcreate(H5P_DATASET_CREATE);
  H5Pset_external(external, (folder_ / "secret").c_str(), 0, 32);
  write_square("external.h5", 2, external);
  EXPECT_THAT(message_for("external.h5"), HasSubstr("'/K' lie in other files"));

  write_square("dense.h5", 2, H5Pcreate(H5P_DATASET_CREATE));
  const hid_t file = create("virtual.h5");
  const hsize_t sizes[] = {2, 2};
  const hid_t space = H5Screate_simple(2, sizes, nullptr);
  const hid_t creation = H5Pcreate(H5P_DATASET_CREATE);
  H5Pset_virtual(creation, space, (folder_ / "dense.h5").c_str(), "K", space);
  H5Dclose(H5Dcreate2(file, "K", H5T_NATIVE_DOUBLE, space, H5P_DEFAULT, creation, H5P_DEFAULT));
  H5Pclose(creation);
  H5Sclose(space);
  H5Fclose(file);
  EXPECT_THAT(message_for("virtual.h5"), HasSubstr("'/K' lie in other files"));
}

TEST_F(HostileHdf5, ExtentsAreHeldAgainstWhatIsStored) {
  write_square("bomb.h5", 20000, packed_chunks(64));
  EXPECT_THAT(message_for("bomb.h5"), HasSubstr("'/K' claims more numbers than the"));
  write_square("chunk.h5", 4000, packed_chunks(4000));  // honest: 128 MB of zeros in 125 KB
  EXPECT_EQ(read_symmetric_matrix((folder_ / "chunk.h5").string()).lower.nonZeros(), 1);
  write_square("early.h5", 3, H5Pcreate(H5P_DATASET_CREATE));
  EXPECT_EQ(read_symmetric_matrix((folder_ / "early.h5").string()).lower.rows(), 3);
}

TEST_F(HostileHdf5, TheLargestNumberIsNoIndex) {
  // Counted from 1 it would be the most negative number, and undefined behaviour on the way there.
  constexpr long long k_largest = std::numeric_limits<long long>::max();
  write_vectors("row.h5", {{"data", {2, 3}}, {"row", {0, k_largest}}, {"col", {0, 1}}});
  write_vectors("column.h5", {{"data", {2, 3}}, {"row", {0, 1}}, {"col", {0, k_largest}}});
  write_vectors("indices.h5", {{"data", {2, 3}}, {"indptr", {0, 1, 2}}, {"indices", {0, k_largest}}});
  for (const char* file : {"row.h5", "column.h5", "indices.h5"}) {
    EXPECT_THAT(message_for(file), AllOf(HasSubstr("9223372036854775807"), Not(HasSubstr("-9223372036854775808"))))
        << file;
  }
  write_vectors("pointer.h5", {{"data", {2, 3}}, {"indptr", {0, k_largest, 2}}, {"indices", {0, 1}}});
  EXPECT_THAT(message_for("pointer.h5"), HasSubstr("'/K/indptr' is not ascending"));
}

TEST_F(HostileHdf5, AFileThatIsCutShortIsRefused) {
  write_square("dense.h5", 30, H5Pcreate(H5P_DATASET_CREATE));
  const std::string whole = read_file(folder_ / "dense.h5");
  for (const std::size_t size : {whole.size() / 4, whole.size() / 2, whole.size() - 1}) {
    write_file_atomically(folder_ / "cut.h5", whole.substr(0, size));
    EXPECT_THAT(message_for("cut.h5"), HasSubstr("cut.h5: ")) << size;
  }
}

/// Datasets as MATLAB writes them in version 7.3.
class MatHdf5 : public HostileHdf5 {
 protected:
  void write_head(const std::string& name) {
    std::string head = "MATLAB 7.3 MAT-file";
    head.resize(124, ' ');
    head += std::string("\0\2IM", 4);
    std::fstream(folder_ / name, std::ios::in | std::ios::out | std::ios::binary) << head;
  }
  static void add_class(hid_t set, const std::string& name) {
    const hid_t type = H5Tcopy(H5T_C_S1);
    H5Tset_size(type, name.size());
    const hid_t space = H5Screate(H5S_SCALAR);
    const hid_t attribute = H5Acreate2(set, "MATLAB_class", type, space, H5P_DEFAULT, H5P_DEFAULT);
    H5Awrite(attribute, type, name.data());
    H5Aclose(attribute);
    H5Sclose(space);
    H5Tclose(type);
  }
  static void add(hid_t file, const std::string& name, const std::string& array_class, hid_t type,
                  const std::vector<hsize_t>& sizes, const void* data) {
    const hid_t space = H5Screate_simple(static_cast<int>(sizes.size()), sizes.data(), nullptr);
    const hid_t links = H5Pcreate(H5P_LINK_CREATE);
    H5Pset_create_intermediate_group(links, 1);
    const hid_t set = H5Dcreate2(file, name.c_str(), type, space, links, H5P_DEFAULT, H5P_DEFAULT);
    if (data != nullptr) H5Dwrite(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, data);
    add_class(set, array_class);
    H5Dclose(set);
    H5Pclose(links);
    H5Sclose(space);
  }
  /// Cells whose texts lie below /#refs#; a cell "" is the cell array itself.
  static void add_cells(hid_t file, const std::string& name, const std::vector<std::string>& texts) {
    std::vector<hobj_ref_t> references(texts.size());
    const hsize_t count = texts.size();
    add(file, name, "cell", H5T_STD_REF_OBJ, {1, count}, references.data());
    for (std::size_t k = 0; k < texts.size(); ++k) {
      const std::string place = texts[k].empty() ? name : "/#refs#/" + std::to_string(k);
      const std::vector<std::uint16_t> codes(texts[k].begin(), texts[k].end());
      if (!texts[k].empty()) add(file, place, "char", H5T_NATIVE_UINT16, {codes.size(), 1}, codes.data());
      H5Rcreate(&references[k], file, place.c_str(), H5R_OBJECT, -1);
    }
    const hid_t set = H5Dopen2(file, name.c_str(), H5P_DEFAULT);
    H5Dwrite(set, H5T_STD_REF_OBJ, H5S_ALL, H5S_ALL, H5P_DEFAULT, references.data());
    H5Dclose(set);
  }
};

TEST_F(MatHdf5, NumbersTextsAndCellsAreRead) {
  const hid_t file = create("tests.mat", 512);
  const std::vector<double> frequencies = {1.0, 2.0, 3.0, 4.0, 5.0, 6.0};
  add(file, "frequencies", "double", H5T_NATIVE_DOUBLE, {3, 2}, frequencies.data());
  const std::vector<std::uint16_t> letters = {'a', 'c', 'b', 'd'};
  add(file, "rows", "char", H5T_NATIVE_UINT16, {2, 2}, letters.data());
  add_cells(file, "dofs", {"101:+Z", "7:-X"});
  add_cells(file, "itself", {"a", ""});
  H5Gclose(H5Gcreate2(file, "structure", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
  H5Fclose(file);
  write_head("tests.mat");
  const auto variables = read_mat((folder_ / "tests.mat").string());
  EXPECT_THAT(variables.at("frequencies").sizes, ElementsAre(2, 3));
  EXPECT_EQ(variables.at("frequencies").numbers, frequencies);
  EXPECT_THAT(variables.at("rows").texts, ElementsAre("ab", "cd"));
  EXPECT_THAT(variables.at("dofs").texts, ElementsAre("101:+Z", "7:-X"));
  EXPECT_EQ(variables.size(), 3U);
}

TEST_F(MatHdf5, NumbersThatAreNotStoredOrLieElsewhereAreRefused) {
  hid_t file = create("claim.mat", 512);
  add(file, "f1", "double", H5T_NATIVE_DOUBLE, {20000, 20000}, nullptr);
  H5Fclose(file);
  write_head("claim.mat");
  EXPECT_THAT(message_of<FormatError>([&] { read_mat((folder_ / "claim.mat").string()); }),
              HasSubstr("'f1' claims more numbers than the 0 bytes"));
  file = create("link.mat", 512);
  H5Lcreate_external("other.mat", "/f1", file, "f1", H5P_DEFAULT, H5P_DEFAULT);
  H5Fclose(file);
  write_head("link.mat");
  EXPECT_THAT(message_of<FormatError>([&] { read_mat((folder_ / "link.mat").string()); }), HasSubstr("'other.mat'"));
}

}  // namespace
}  // namespace mottle::formats
