// The files of a CalculixDeck as they are written elsewhere.
#include <algorithm>
#include <map>
#include <set>
#include <utility>

#include "formats/calculix/steps.hpp"
#include "mottle/core/files.hpp"
#include "mottle/core/text.hpp"
#include "mottle/formats/calculix/deck.hpp"

namespace mottle::formats {
namespace {

namespace fs = std::filesystem;

/// A line of a file as it was read, and the texts that go into it: by the place of the first letter that each replaces,
/// with the number of these letters.
struct ChangedLine {
  std::string before;
  std::map<std::size_t, std::pair<std::size_t, std::string>> texts;
};
using ChangedLines = std::map<int, ChangedLine>;  // by number

std::string changed_file(const std::string& name, const ChangedLines& lines) {
  const std::string bytes = read_file(name);
  std::string written;
  std::size_t copied = 0;
  std::size_t start = 0;
  int number = 1;
  for (const auto& [line, change] : lines) {
    for (; number < line && start <= bytes.size(); ++number) {
      const std::size_t end = bytes.find('\n', start);
      start = end == std::string::npos ? bytes.size() + 1 : end + 1;
    }
    if (start > bytes.size() || bytes.compare(start, change.before.size(), change.before) != 0) {
      throw FormatError(name, line, "was changed since the deck was read");
    }
    for (const auto& [begin, replaced] : change.texts) {
      written.append(bytes, copied, start + begin - copied).append(replaced.second);
      copied = start + begin + replaced.first;
    }
  }
  return written.append(bytes, copied, std::string::npos);
}

/// Each file once, however it is named, and its name in the new folder: as in the deck's own where it lies there.
class NewNames {
 public:
  explicit NewNames(const CalculixDeck& deck) {
    const fs::path root(deck.files.front());
    const fs::path folder = fs::weakly_canonical(fs::absolute(root).parent_path());
    add(root, root.filename());
    for (const std::string& file : deck.files) {
      const fs::path inside = key_of(file).lexically_relative(folder);
      add(file, inside.empty() || *inside.begin() == ".." ? fs::path(file).filename() : inside);
    }
  }

  static fs::path key_of(const fs::path& file) { return fs::weakly_canonical(fs::absolute(file)); }
  const fs::path& of(const fs::path& file) const { return names_.at(key_of(file)); }

 private:
  void add(const fs::path& file, fs::path name) {
    if (names_.contains(key_of(file))) return;
    for (int number = 2; taken_.contains(name); ++number) {
      name.replace_filename(fmt::format("{}-{}{}", fs::path(file).stem().string(), number, name.extension().string()));
    }
    taken_.insert(name);
    names_.emplace(key_of(file), std::move(name));
  }

  std::map<fs::path, fs::path> names_;
  std::set<fs::path> taken_;
};

class Changes {
 public:
  explicit Changes(const CalculixDeck& deck) : deck_(deck) {}

  void add(const CalculixDeck::Line& line, std::size_t begin, std::size_t length, const std::string& text) {
    const std::string& file = deck_.files[static_cast<std::size_t>(line.file)];
    ChangedLine& change = changes_[NewNames::key_of(file)][line.number];
    change.before = line.text;
    const auto [found, is_new] = change.texts.emplace(begin, std::pair(length, text));
    if (is_new || found->second.second == text) return;
    throw FormatError(file, line.number,
                      fmt::format("is included twice and would have to say {} and {}", found->second.second, text));
  }
  const ChangedLines& of(const std::string& file) { return changes_[NewNames::key_of(file)]; }

 private:
  const CalculixDeck& deck_;
  std::map<fs::path, ChangedLines> changes_;
};

}  // namespace

std::vector<CalculixFile> deck_files_with_replacements(const CalculixDeck& deck,
                                                       const std::vector<CalculixReplacement>& replacements) {
  const NewNames names(deck);
  Changes changes(deck);
  for (const auto& [number, text] : replacements)
    changes.add(deck.lines[number.line], number.begin, number.length, text);
  for (const CalculixDeck::Include& include : deck.includes) {
    const fs::path folder = names.of(deck.files[static_cast<std::size_t>(include.line.file)]).parent_path();
    const fs::path& name = names.of(deck.files[static_cast<std::size_t>(include.included)]);
    const fs::path written = include.line.text.substr(include.begin, include.length);
    if (written.is_relative() && (folder / written).lexically_normal() == name) continue;
    changes.add(include.line, include.begin, include.length,
                (folder.empty() ? name : name.lexically_relative(folder)).generic_string());
  }
  std::vector<CalculixFile> files;
  for (const std::string& file : deck.files) {
    const fs::path& name = names.of(file);
    if (std::ranges::find(files, name, &CalculixFile::name) != files.end()) continue;
    files.push_back({name, changed_file(file, changes.of(file))});
  }
  return files;
}

}  // namespace mottle::formats
