// Models and refusals of decks that tests write as text.
#pragma once

#include <string>

#include "core/message_of.hpp"
#include "mottle/core/error.hpp"
#include "mottle/formats/nastran/model.hpp"

namespace mottle::test {

using namespace formats;  // of which these are the tests

inline NastranModel model_of(const std::string& deck, const NastranOptions& options = {}) {
  return build_nastran_model(parse_nastran_deck(deck, "deck.bdf"), options);
}

inline std::string refusal_of(const std::string& deck, const NastranOptions& options = {}) {
  return message_of<FormatError>([&] { model_of(deck, options); });
}

/// "card:id:name" of a field; "none" for k_no_field.
inline std::string field_name(const FiniteElementModel& model, FieldIndex index) {
  if (index == k_no_field) return "none";
  const CardField& field = model.fields[static_cast<std::size_t>(index)];
  return field.card + ':' + std::to_string(field.id) + ':' + field.name;
}

/// Index of the field "card:id:name"; k_no_field where there is none.
inline FieldIndex find_field(const FiniteElementModel& model, const std::string& name) {
  for (FieldIndex i = 0; i < static_cast<FieldIndex>(model.fields.size()); ++i) {
    if (field_name(model, i) == name) return i;
  }
  return k_no_field;
}

inline double value_of(const FiniteElementModel& model, const std::string& name) {
  return model.value(find_field(model, name), -999.0);
}

inline const Node& node(const FiniteElementModel& model, int id) {
  return model.nodes.at(static_cast<std::size_t>(model.find_node(id)));
}

/// A cube of edge 2: grid points 1..4 below, 5..8 above, and a steel.
inline const std::string k_cube =
    "GRID,1,,0.,0.,0.\nGRID,2,,2.,0.,0.\nGRID,3,,2.,2.,0.\nGRID,4,,0.,2.,0.\n"
    "GRID,5,,0.,0.,2.\nGRID,6,,2.,0.,2.\nGRID,7,,2.,2.,2.\nGRID,8,,0.,2.,2.\n"
    "MAT1,1,2.1+11,,.3,7850.\n";

}  // namespace mottle::test
