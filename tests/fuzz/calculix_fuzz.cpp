// libFuzzer target for formats/calculix_deck: whatever the bytes, a deck is refused with InvalidInput or its numbers
// stand where they are said to and can be replaced. A line "$FILE" begins the next file: *INCLUDE, INPUT=1 names the
// first one behind it. Parts of Abaqus decks are put into flat ones. Seeds: tests/fuzz/calculix,
// examples/03-plate-calculix.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>

#include "fuzz_folder.hpp"
#include "mottle/core/error.hpp"
#include "mottle/core/text.hpp"
#include "mottle/formats/calculix/deck.hpp"

namespace {

using namespace mottle;
using namespace mottle::formats;

void expect(bool claim) {
  if (!claim) std::abort();
}

std::string write_files(const test::FuzzFolder& folder, std::string_view bytes) {
  constexpr std::string_view k_border = "$FILE\n";
  constexpr int k_max_files = 4;
  int file = 0;
  for (std::size_t border = 0; border != std::string_view::npos && file < k_max_files; ++file) {
    border = bytes.find(k_border);
    folder.write(std::to_string(file), bytes.substr(0, border));
    bytes.remove_prefix(border == std::string_view::npos ? bytes.size() : border + k_border.size());
  }
  for (; file < k_max_files; ++file) folder.write(std::to_string(file), "");
  return folder.path("0");
}

template <typename Action>
void attempt(const Action& action) {
  try {
    action();
  } catch (const InvalidInput& error) {
    expect(std::string_view(error.what()).size() < 65536);
  }
}

bool has_parts(const CalculixDeck& deck) {
  return std::any_of(deck.lines.begin(), deck.lines.end(), [](const CalculixDeck::Line& line) {
    return capitals(line.text).find("PART") != std::string::npos ||
           capitals(line.text).find("INSTANCE") != std::string::npos;
  });
}

void check_target(const CalculixDeck& deck, const std::string& target) {
  const std::vector<CalculixNumber> numbers = find_calculix_numbers(deck, target);
  expect(!numbers.empty());
  std::vector<CalculixChange> changes;
  std::vector<CalculixReplacement> replacements;
  for (const CalculixNumber& number : numbers) {
    expect(number.line < deck.lines.size() && number.begin + number.length <= deck.lines[number.line].text.size());
    expect(number.is_placeholder || std::isfinite(number.value));
    changes.push_back({number, 1.5});
    replacements.push_back({number, "{{p}}"});
  }
  attempt([&] { expect(!matrix_storage_deck(deck, changes).empty()); });
  attempt([&] {
    const std::vector<CalculixFile> files = deck_files_with_replacements(deck, replacements);
    expect(std::ranges::any_of(files,
                               [](const CalculixFile& file) { return file.bytes.find("{{p}}") != std::string::npos; }));
  });
  attempt([&] {  // a part that nothing is an instance of does not come into the flat deck
    const bool is_written = deck_with_replacements(deck, replacements).find("{{p}}") != std::string::npos;
    expect(is_written || has_parts(deck));
  });
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const test::FuzzFolder folder;
  const std::string main = write_files(folder, {reinterpret_cast<const char*>(data), size});
  attempt([&] {
    const CalculixDeck deck = read_calculix_deck(main);
    for (std::size_t line = 0; line < deck.lines.size(); ++line) expect(!deck.where(line).empty());
    writes_displacements(deck);
    attempt([&] { element_notes(deck); });
    attempt([&] { list_calculix_targets(deck); });
    attempt([&] { expect(!deck_without_steps(deck).empty()); });
    attempt([&] { expect(!matrix_storage_deck(deck, {}).empty()); });
    attempt([&] { expect(!deck_with_replacements(deck, {}).empty()); });
    for (const char* target : {"*ELASTIC:STEEL:E", "*ELASTIC:STEEL:NU", "*DENSITY:STEEL", "*SPRING:BOLTS", "*MASS:TIPS",
                               "*SHELL SECTION:PLATE:T", "{{a}}"}) {
      attempt([&] { check_target(deck, target); });
    }
  });
  return 0;
}
