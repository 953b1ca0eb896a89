#include "mottle/formats/nastran/rewrite.hpp"

#include <algorithm>
#include <cmath>
#include <deque>
#include <map>

#include "formats/nastran/fields.hpp"
#include "formats/nastran/rows.hpp"
#include "mottle/core/error.hpp"
#include "mottle/core/files.hpp"
#include "mottle/core/text.hpp"

namespace mottle::formats {
namespace {

std::string name_of(const FieldChange& change) {
  return fmt::format("{}:{}:{}", change.card, change.id, change.name);
}

/// Index of the field that a change names.
std::size_t index_of(const FiniteElementModel& model, const FieldChange& change) {
  const auto found = std::ranges::find_if(model.fields, [&](const CardField& field) {
    return field.card == change.card && field.id == change.id && field.name == change.name;
  });
  require(found != model.fields.end(), "'{}': the deck has no such number on a card", name_of(change));
  return static_cast<std::size_t>(found - model.fields.begin());
}

/// A field of a card: which one in NastranDeck::cards, and the number of the field from 0.
struct Place {
  std::size_t card = 0, field = 0;
};

/// Fields of the cards of that name and id that hold the number.
std::vector<Place> places_of(const NastranDeck& deck, const FieldChange& change, double value) {
  std::vector<Place> places;
  for (std::size_t c = 0; c < deck.cards.size(); ++c) {
    const BulkCard& card = deck.cards[c];
    if (card.name != change.card) continue;
    const bool has_id = std::ranges::any_of(card.fields, [&](std::string_view text) {
      int id = 0;
      return nastran::parse_integer(text, id) && id == change.id;
    });
    for (std::size_t f = 0; has_id && f < card.fields.size(); ++f) {
      double number = 0.0;
      if (nastran::parse_real(card.fields[f], number) && number == value) places.push_back({c, f});
    }
  }
  return places;
}

/// Whether that number alone changes where another text stands in that place.
bool is_source(const NastranDeck& deck, const NastranOptions& options, const FiniteElementModel& before,
               std::size_t field, const Place& place) {
  NastranDeck moved = deck;
  std::vector<std::string_view> fields(deck.cards[place.card].fields.begin(), deck.cards[place.card].fields.end());
  const std::string text = nastran_real(1.25 * before.fields[field].value, 16);
  fields[place.field] = text;
  moved.cards[place.card].fields = fields;
  try {
    const FiniteElementModel after = build_nastran_model(moved, options).model;
    return after.fields.size() == before.fields.size() && after.fields[field].value != before.fields[field].value;
  } catch (const InvalidInput&) {  // an id or a flag
    return false;
  }
}

Place find_place(const NastranDeck& deck, const NastranOptions& options, const FiniteElementModel& model,
                 const FieldChange& change) {
  const std::size_t field = index_of(model, change);
  std::vector<Place> places = places_of(deck, change, model.fields[field].value);
  if (places.size() > 1) {
    std::erase_if(places, [&](const Place& place) { return !is_source(deck, options, model, field, place); });
  }
  require(places.size() == 1, "'{}' cannot be written into the deck: {}", name_of(change),
          places.empty() ? "it is computed from other numbers of its card" : "it stands on several cards");
  return places.front();
}

/// Where a field's text stands in the bytes of its file.
struct Span {
  std::size_t begin = 0, length = 0;
  int width = 8;           ///< characters that the number may have
  bool is_padded = false;  ///< in columns: filled up with blanks
};

Span span_of(const NastranDeck& deck, const std::string& bytes, const BulkCard& card, std::string_view text,
             const std::string& what) {
  const auto file = std::ranges::find_if(deck.text->bytes, [&](const std::string& candidate) {
    return text.data() >= candidate.data() && text.data() < candidate.data() + candidate.size();
  });
  require(file != deck.text->bytes.end() && file->size() == bytes.size(),
          "{}: '{}' cannot be written into the deck: its line has tabs or repeats another one by '='; write it out",
          deck.location_of(card), what);
  const auto begin = static_cast<std::size_t>(text.data() - file->data());
  const std::size_t line =
      bytes.find_last_of("\r\n", begin) == std::string::npos ? 0 : bytes.find_last_of("\r\n", begin) + 1;
  const std::string_view whole(bytes.data() + line, std::min(bytes.find_first_of("\r\n", begin), bytes.size()) - line);
  const bool is_free = nastran::without_comment(whole).find(',') != std::string_view::npos;
  const bool is_large = whole.substr(0, 8).find('*') != std::string_view::npos;
  const int width = is_large ? 16 : 8;
  if (is_free) return {begin, text.size(), width, false};
  const std::size_t box = 8 + (begin - line - 8) / static_cast<std::size_t>(width) * static_cast<std::size_t>(width);
  return {line + box, std::min(static_cast<std::size_t>(width), whole.size() - box), width, true};
}

/// The rewritten files, read as a deck.
NastranDeck parse_again(const RewrittenDeck& deck) {
  std::map<std::string, std::string> files;
  for (const RewrittenFile& file : deck.files) files[file.name] = file.bytes;
  std::size_t next = 1;
  const auto in_order = [&](const std::string&, const std::string&) -> std::optional<IncludedFile> {
    if (next >= deck.files.size()) return std::nullopt;
    const RewrittenFile& file = deck.files[next++];
    return IncludedFile{file.name, file.bytes};
  };
  return parse_nastran_deck(deck.files.front().bytes, deck.files.front().name, in_order);
}

/// These numbers have changed to what is wanted, and no others.
void require_as_wanted(const FiniteElementModel& before, const NastranOptions& options,
                       const std::vector<FieldChange>& changes, RewrittenDeck& deck) {
  constexpr double k_digits = 1e-4;
  const FiniteElementModel after = build_nastran_model(parse_again(deck), options).model;
  std::map<std::size_t, double> wanted;
  for (const FieldChange& change : changes) wanted[index_of(before, change)] = change.value;
  bool is_right = after.fields.size() == before.fields.size() && after.nodes.size() == before.nodes.size();
  for (std::size_t k = 0; is_right && k < after.fields.size(); ++k) {
    const auto change = wanted.find(k);
    if (change == wanted.end()) {
      is_right = after.fields[k].value == before.fields[k].value;
      continue;
    }
    const double error = std::abs(after.fields[k].value - change->second) / std::abs(change->second);
    deck.rounding = std::max(deck.rounding, change->second == 0.0 ? 0.0 : error);
    is_right = change->second == 0.0 ? after.fields[k].value == 0.0 : error < k_digits;
  }
  require(is_right, "{}: the numbers cannot be changed by themselves: another one depends on them",
          deck.files.front().name);
}

}  // namespace

RewrittenDeck rewrite_nastran_deck(const std::filesystem::path& file, const NastranOptions& options,
                                   const std::vector<FieldChange>& changes) {
  const NastranDeck deck = read_nastran_deck(file);
  const FiniteElementModel model = build_nastran_model(deck, options).model;
  RewrittenDeck result;
  for (const std::string& name : deck.files) result.files.push_back({name, read_file(name)});
  std::map<std::pair<int, std::size_t>, std::pair<Span, std::string>, std::greater<>>
      edits;  // from the end of each file
  for (const FieldChange& change : changes) {
    const Place place = find_place(deck, options, model, change);
    const BulkCard& card = deck.cards[place.card];
    const std::string& bytes = result.files[static_cast<std::size_t>(card.file)].bytes;
    const Span span = span_of(deck, bytes, card, card.fields[place.field], name_of(change));
    std::string text = nastran_real(change.value, span.width);
    if (span.is_padded) text.resize(static_cast<std::size_t>(span.width), ' ');
    edits[{card.file, span.begin}] = {span, text};
  }
  for (const auto& [where, edit] : edits) {
    result.files[static_cast<std::size_t>(where.first)].bytes.replace(where.second, edit.first.length, edit.second);
  }
  require_as_wanted(model, options, changes, result);
  return result;
}

}  // namespace mottle::formats
