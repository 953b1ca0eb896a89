// Files of an exported CalculiX deck: names, includes and bytes.
#include <gtest/gtest.h>

#include <filesystem>
#include <map>

#include "core/temporary_folder.hpp"
#include "mottle/core/error.hpp"
#include "mottle/core/files.hpp"
#include "mottle/formats/calculix/deck.hpp"

namespace mottle::formats {
namespace {

namespace fs = std::filesystem;

class DeckFiles : public ::testing::Test {
 protected:
  DeckFiles() { fs::create_directories(root_ / "deck/parts"); }

  void write(const fs::path& name, const std::string& bytes) const { write_file_atomically(root_ / name, bytes); }

  /// The exported files by name, with 8. as the modulus of material A.
  std::map<std::string, std::string> exported(const fs::path& deck_file) const {
    const CalculixDeck deck = read_calculix_deck(root_ / deck_file);
    std::vector<CalculixReplacement> replacements;
    for (const CalculixNumber& number : find_calculix_numbers(deck, "*ELASTIC:A:E"))
      replacements.push_back({number, "8."});
    std::map<std::string, std::string> files;
    for (const CalculixFile& file : deck_files_with_replacements(deck, replacements)) {
      files[file.name.generic_string()] = file.bytes;
    }
    return files;
  }

  test::TemporaryFolder root_;
};

const std::string k_material = "*MATERIAL, NAME=A\r\n*ELASTIC\r\n7., .3\r\n";
const std::string k_changed = "*MATERIAL, NAME=A\r\n*ELASTIC\r\n8., .3\r\n";

TEST_F(DeckFiles, KeepTheirPlacesAndAllOtherBytes) {
  write("deck/parts/a.inc", k_material + "** last line");
  write("deck/d.inp", "*HEADING\n a deck\r\n*INCLUDE, INPUT=parts/a.inc\n\n** end");
  EXPECT_EQ(exported("deck/d.inp"),
            (std::map<std::string, std::string>{{"d.inp", "*HEADING\n a deck\r\n*INCLUDE, INPUT=parts/a.inc\n\n** end"},
                                                {"parts/a.inc", k_changed + "** last line"}}));
}

TEST_F(DeckFiles, AnIncludeFromElsewhereComesAlong) {
  write("a.inc", k_material);
  write("deck/d.inp", "*INCLUDE, INPUT = \"../a.inc\"\r\n*DENSITY\r\n1.\r\n");
  EXPECT_EQ(exported("deck/d.inp"),
            (std::map<std::string, std::string>{{"d.inp", "*INCLUDE, INPUT = \"a.inc\"\r\n*DENSITY\r\n1.\r\n"},
                                                {"a.inc", k_changed}}));
}

TEST_F(DeckFiles, AnAbsoluteIncludeNamesTheNewFile) {
  write("deck/parts/a.inc", k_material);
  write("deck/d.inp", "*INCLUDE,INPUT=" + (root_ / "deck/parts/a.inc").string() + "\n");
  EXPECT_EQ(exported("deck/d.inp"), (std::map<std::string, std::string>{{"d.inp", "*INCLUDE,INPUT=parts/a.inc\n"},
                                                                        {"parts/a.inc", k_changed}}));
}

TEST_F(DeckFiles, OneFileOfSeveralNamesIsWrittenOnce) {
  write("deck/b.inc", "** nothing\n");
  write("deck/parts/a.inc", k_material);
  write("deck/d.inp", "*INCLUDE,INPUT=b.inc\n*INCLUDE,INPUT=parts/a.inc\n*INCLUDE,INPUT=./b.inc\n");
  const auto files = exported("deck/d.inp");
  EXPECT_EQ(files.size(), 3U);
  EXPECT_EQ(files.at("parts/a.inc"), k_changed);
}

TEST_F(DeckFiles, FilesOfOneNameFromDifferentFoldersStayApart) {
  write("a.inc", k_material);
  write("deck/a.inc", "** of the deck\n");
  write("deck/d.inp", "*INCLUDE,INPUT=a.inc\n*INCLUDE,INPUT=../a.inc\n");
  const auto files = exported("deck/d.inp");
  EXPECT_EQ(files.at("a.inc"), "** of the deck\n");
  EXPECT_EQ(files.at("a-2.inc"), k_changed);
  EXPECT_EQ(files.at("d.inp"), "*INCLUDE,INPUT=a.inc\n*INCLUDE,INPUT=a-2.inc\n");
}

TEST_F(DeckFiles, ALinkedDeckKeepsItsName) {
  write("deck/real.inp", k_material);
  fs::create_symlink(root_ / "deck/real.inp", root_ / "link.inp");
  EXPECT_EQ(exported("link.inp"), (std::map<std::string, std::string>{{"link.inp", k_changed}}));
}

TEST_F(DeckFiles, AFileThatHasChangedIsRefused) {
  write("deck/d.inp", k_material);
  const CalculixDeck deck = read_calculix_deck(root_ / "deck/d.inp");
  write("deck/d.inp", "** a line\n" + k_material);
  const std::vector<CalculixReplacement> replacements{{find_calculix_numbers(deck, "*ELASTIC:A:E").front(), "8."}};
  EXPECT_THROW((void)deck_files_with_replacements(deck, replacements), FormatError);
}

}  // namespace
}  // namespace mottle::formats
