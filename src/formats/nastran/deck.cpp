// The sections of a deck line by line, through the files that it includes.
#include "mottle/formats/nastran/deck.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "formats/nastran/case.hpp"
#include "formats/nastran/includes.hpp"
#include "formats/nastran/rows.hpp"
#include "mottle/core/error.hpp"
#include "mottle/core/text.hpp"

namespace mottle::formats {
namespace nastran {
namespace {

constexpr std::size_t k_longest_line = 65536;
constexpr std::size_t k_max_rows = 20'000'000;
constexpr std::size_t k_max_includes = 1000;
constexpr std::size_t k_deepest_include = 32;
constexpr int k_max_lines_of_a_file_name = 20;
constexpr int k_max_lines_of_a_command = 100'000;

/// Where the line that begins at `at` ends.
std::size_t end_of_line(std::string_view bytes, std::size_t at) {
  while (at < bytes.size() && bytes[at] != '\n' && bytes[at] != '\r') ++at;
  return at;
}

/// The lines of one file. Ends of lines are LF, CR LF or CR.
class LineSource {
 public:
  LineSource(std::string& bytes, const std::string& file) : bytes_(bytes), file_(file) {
    if (bytes.starts_with("\xEF\xBB\xBF")) at_ = 3;
    if (bytes.starts_with("\xFF\xFE") || bytes.starts_with("\xFE\xFF")) {
      throw FormatError(file, 0, "is UTF-16 text; save it as plain ASCII or UTF-8");
    }
  }

  /// The next line without its comment; false at the end.
  bool next(std::string_view& line) {
    if (at_ >= bytes_.size()) return false;
    ++number_;
    const std::size_t end = end_of_line(bytes_, at_);
    if (end - at_ > k_longest_line) {
      fail(location(), fmt::format("the line has more than {} characters", k_longest_line));
    }
    line = without_comment(std::string_view(bytes_).substr(at_, end - at_));
    const bool is_pair = bytes_.compare(end, 2, "\r\n") == 0;
    at_ = end + (is_pair ? 2 : 1);
    return true;
  }

  std::string& bytes() { return bytes_; }
  int number() const { return number_; }
  SourceLocation location() const { return {file_, number_}; }

 private:
  std::string& bytes_;
  const std::string& file_;
  std::size_t at_ = 0;
  int number_ = 0;
};

/// The first word in capitals; empty where the line begins with none.
std::string first_word(std::string_view line) {
  line = trim(line);
  const std::size_t end = std::min(line.find_first_of(" \t=,('\"*"), line.size());
  return end > 8 ? std::string() : capitals(line.substr(0, end));
}

/// Whether a line of the file begins with that word.
bool has_line(std::string_view bytes, std::string_view word) {
  for (std::size_t at = 0; at < bytes.size();) {
    const std::size_t end = end_of_line(bytes, at);
    const char first = trim(bytes.substr(at, 9)).empty() ? ' ' : trim(bytes.substr(at, 9)).front();
    const bool may_match = first == word.front() || first == static_cast<char>(word.front() - 'A' + 'a');
    if (may_match && first_word(bytes.substr(at, end - at)) == word) return true;
    at = end + 1;
  }
  return false;
}

class DeckReader {
 public:
  DeckReader(const IncludeResolver& resolve, NastranDeck& deck, NastranDeck::Text& text)
      : resolve_(resolve), deck_(deck), text_(text), replication_(text) {}

  void read(std::string bytes, const std::string& name) {
    if (has_line(bytes, "CEND")) {
      section_ = Section::executive;
    } else if (has_line(bytes, "BEGIN")) {
      section_ = Section::case_control;
    }
    read_file_text(std::move(bytes), name);
    if (section_ == Section::executive || section_ == Section::case_control) {
      throw FormatError(name, 0, "no BEGIN BULK in it; the cards must follow that line");
    }
    join_rows(rows_, deck_, text_);
  }

 private:
  enum class Section : std::uint8_t { executive, case_control, bulk, done };

  void read_file_text(std::string bytes, const std::string& name) {
    total_bytes_ += bytes.size();
    if (total_bytes_ > k_max_bytes) {
      throw FormatError(name, 0, fmt::format("the deck is larger than {} bytes with this file", k_max_bytes));
    }
    deck_.files.push_back(name);
    open_.push_back(static_cast<int>(deck_.files.size()) - 1);
    LineSource source(text_.bytes.emplace_back(std::move(bytes)), name);
    for (std::string_view line; section_ != Section::done && source.next(line);) read_line(line, source);
    open_.pop_back();
  }

  void read_line(std::string_view line, LineSource& source) {
    const std::string_view trimmed = trim(line);
    if (trimmed.empty()) return;
    const char first = trimmed.front();
    const bool may_be_a_statement = section_ != Section::bulk || first == 'I' || first == 'i' || first == 'E' ||
                                    first == 'e' || first == 'B' || first == 'b';
    const std::string word = may_be_a_statement ? first_word(trimmed) : std::string();
    if (word == "INCLUDE") {
      read_include(trimmed.substr(word.size()), source);
    } else if (word == "BEGIN") {
      begin_bulk(trimmed, source.location());
    } else if (section_ == Section::bulk) {
      read_bulk_line(word, line, source);
    } else if (word == "CEND") {
      section_ = Section::case_control;
    } else if (word == "SOL") {
      read_solution(trimmed);
    } else if (section_ == Section::case_control) {
      read_command(word, trimmed, source);
    }
  }

  void begin_bulk(std::string_view line, const SourceLocation& location) {
    const std::string text = capitals(line);
    if (text.find("SUPER") != std::string::npos || text.find("AUX") != std::string::npos) {
      fail(location,
           fmt::format("'{}': superelements and auxiliary models are not supported; write the whole structure "
                       "as one model",
                       shown(line)));
    }
    section_ = Section::bulk;
  }

  void read_bulk_line(const std::string& word, std::string_view line, LineSource& source) {
    if (word == "ENDDATA") {
      section_ = Section::done;
      return;
    }
    if (rows_.size() >= k_max_rows) fail(source.location(), fmt::format("more than {} lines of bulk data", k_max_rows));
    make_capitals(source.bytes(), line);
    // The text of an equation has commas of its own; it goes on in lines that begin with a mark or a blank.
    const bool goes_on = is_equation_ && (line.front() == ' ' || line.front() == '+' || line.front() == '*');
    is_equation_ = goes_on || line.starts_with("DEQATN");
    if (goes_on) return;
    if (is_equation_) line = line.substr(0, 6);
    BulkRow row = cut_row(line, source.location(), text_);
    row.file = open_.back();
    row.line = source.number();
    if (row.kind == BulkRow::Kind::replication) {
      replication_.read(row, source.location(), rows_);
    } else {
      replication_.forget();
      rows_.push_back(row);
    }
  }

  void read_solution(std::string_view line) {
    const std::string_view value = trim(line.substr(3));
    deck_.solution = capitals(trim(value.substr(0, value.find_first_of(" ,\t"))));
  }

  /// A command goes on behind a comma at a line's end; a title does not.
  void read_command(const std::string& word, std::string_view line, LineSource& source) {
    const int number = source.number();
    std::string command(line);
    const bool is_text =
        word.ends_with("TITLE") || word.starts_with("TITL") || word.starts_with("SUBT") || word.starts_with("LABE");
    int lines = 1;
    while (!is_text && trim(command).ends_with(',') && source.next(line)) {
      if (++lines > k_max_lines_of_a_command) fail(source.location(), "the command above has too many lines");
      command += ' ';
      command += trim(line);
    }
    read_case_command(command, open_.back(), number, deck_);
  }

  void read_include(std::string_view rest, LineSource& source) {
    const int number = source.number();
    const SourceLocation location{deck_.files[static_cast<std::size_t>(open_.back())], number};
    const std::string written = file_name_of(rest, source);
    if (written.empty()) fail(location, "INCLUDE without a file name");
    if (open_.size() >= k_deepest_include) {
      fail(location, fmt::format("files include each other more than {} levels deep", k_deepest_include));
    }
    if (deck_.files.size() > k_max_includes) fail(location, fmt::format("more than {} included files", k_max_includes));
    std::optional<IncludedFile> found = resolve_ ? resolve_(written, location.file) : std::nullopt;
    if (!found) {
      fail(location, fmt::format("INCLUDE '{}': there is no such file; looked for {}", printable(written),
                                 printable(places_of_include(written, location.file, deck_.files.front()))));
    }
    for (const int open : open_) {
      if (deck_.files[static_cast<std::size_t>(open)] == found->name) {
        fail(location, fmt::format("INCLUDE '{}': that file is being read already, it would include itself without end",
                                   printable(written)));
      }
    }
    read_file_text(std::move(found->bytes), found->name);
  }

  static std::string printable(std::string text) {
    constexpr std::size_t k_longest_path = 300;
    if (text.size() > k_longest_path) text = text.substr(0, k_longest_path) + "...";
    std::replace_if(
        text.begin(), text.end(), [](char c) { return c >= 0 && c < ' '; }, '?');
    return text;
  }

  /// The name behind INCLUDE: bare up to the line's end, or quoted, over several lines if need be.
  std::string file_name_of(std::string_view rest, LineSource& source) {
    rest = trim(rest);
    if (rest.starts_with('=')) rest = trim(rest.substr(1));
    if (rest.empty() || (rest.front() != '\'' && rest.front() != '"')) return std::string(rest);
    const char quote = rest.front();
    rest.remove_prefix(1);
    std::string name;
    const SourceLocation start = source.location();
    for (int lines = 1;; ++lines) {
      const std::size_t end = rest.find(quote);
      name += trim(rest.substr(0, end));
      if (end != std::string_view::npos) return name;
      if (lines > k_max_lines_of_a_file_name || !source.next(rest)) fail(start, "INCLUDE: the quote is not closed");
    }
  }

  const IncludeResolver& resolve_;
  NastranDeck& deck_;
  NastranDeck::Text& text_;
  std::vector<BulkRow> rows_;
  Replication replication_;
  std::vector<int> open_;  ///< files from the main one to the one that is being read
  std::uintmax_t total_bytes_ = 0;
  Section section_ = Section::bulk;
  bool is_equation_ = false;  ///< the last card is a DEQATN
};

}  // namespace
}  // namespace nastran

NastranDeck parse_nastran_deck(std::string bytes, const std::string& name, const IncludeResolver& resolve) {
  NastranDeck deck;
  const auto text = std::make_shared<NastranDeck::Text>();
  nastran::DeckReader(resolve, deck, *text).read(std::move(bytes), name);
  deck.text = text;
  return deck;
}

NastranDeck read_nastran_deck(const std::filesystem::path& file) {
  std::string bytes = nastran::read_limited_file(file, nastran::k_max_bytes);
  return parse_nastran_deck(std::move(bytes), file.string(), nastran::resolver_of_files(file));
}

}  // namespace mottle::formats
