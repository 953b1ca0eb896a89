// Cards and commands that no reader knows: which of them may be skipped, and which would change the model.
#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include "formats/nastran/card_table.hpp"
#include "formats/nastran/rows.hpp"
#include "mottle/core/text.hpp"

namespace mottle::formats::nastran {
namespace {

/// Loads, tables, output, thermal, aeroelastic, optimisation data: no part of stiffness and mass. Skipped in silence.
/// A name that ends with '*' stands for every name that begins so.
constexpr std::string_view k_harmless[] = {
    "FORCE*",  "MOMENT*", "PLOAD*",  "LOAD*",   "GRAV",   "RFORCE*", "TEMP*",  "DEFORM",  "ACCEL*",  "SPCD",
    "DAREA",   "DPHASE",  "DELAY",   "DLOAD",   "RLOAD*", "TLOAD*",  "LSEQ",   "TABLE*",  "TABD*",   "TABR*",
    "FREQ*",   "TSTEP*",  "TF",      "TIC",     "EIGC*",  "EIGB",    "EIGP",   "NOLIN*",  "RANDPS",  "RANDT1",
    "SET*",    "PLOTEL*", "DES*",    "DV*",     "DRESP*", "DCON*",   "DEQATN", "DOPTPRM", "DLINK",   "DSCREEN",
    "DTABLE*", "DDVAL",   "DMI",     "DTI",     "AERO*",  "AE*",     "CAERO*", "PAERO*",  "SPLINE*", "MKAERO*",
    "FLUTTER", "FLFACT",  "TRIM*",   "GUST",    "CSSCHD", "MAT4",    "MAT5",   "MATT*",   "MATS*",   "MATHE",
    "CHBDY*",  "CONV*",   "PCONV*",  "PHBDY",   "QBDY*",  "QHBDY",   "QVECT",  "QVOL",    "RADBC",   "RADM*",
    "RADSET",  "VIEW*",   "CBARAO",  "NLPARM",  "NLPCI",  "NSM",     "NSM1",   "NSML*",   "NSMADD",  "SEQGP",
    "SPCOFF*", "CLOAD*",  "CREEP",   "CAMPBLL", "CNGRNT", "DMIG*",   "MDLPRM", "FBADLAY", "BOUTPUT", "SUPORT1",
    "OUTPUT",  "PANEL",   "SWLDPRM", "MONPNT*", "POINT",  "GMCURV",  "FEEDGE", "FEFACE",  "PSET",    "PVAL",
    "ECHOON",  "ECHOOFF", "USET*",
};

/// Those of the harmless ones that an optimisation would change cards by.
constexpr std::string_view k_design_relations[] = {"DVPREL*", "DVMREL*", "DVCREL*", "DVGRID*", "DVBSHAP", "DVSHAP"};

constexpr int k_max_notes = 30;

/// Everything else that changes stiffness, mass or constraints, besides names that resemble elements.
constexpr std::string_view k_refused[] = {
    "MAT3",    "MAT10",  "MAT11",  "MATG",   "MATHP", "MATORT*", "MATF",    "RBE1",    "RROD",   "RTRPLT*",
    "RSPLINE", "RJOINT", "RSSCON", "RBE2GS", "RBE2F", "PCOMP*",  "PLPLANE", "PLSOLID", "PBCOMP", "PBMSECT",
    "PBRSECT", "PBEAM3", "PSHLN*", "PSLDN1", "SPCAX", "MPCAX",   "RINGAX",  "GRIDB",   "GRIDF",  "SECTAX"};

/// Cards that divide the structure into superelements or belong to one.
constexpr std::string_view k_superelement_cards[] = {
    "SESET",   "SEBULK",  "SECONCT", "SEELT",   "SEEXCLD", "SELABEL", "SELOC",  "SEMPLN",  "SETREE", "SEBNDRY",
    "SEBSET*", "SECSET*", "SEQSET*", "SENQSET", "SESUP*",  "SEUSET*", "CSUPER", "CSUPEXT", "RELEASE"};

/// What a deck may hold instead of a card that is refused.
std::string names_of_read_cards() {
  std::vector<std::string> names;
  for (const CardFamily& family : card_families()) {
    if (!family.names.empty()) names.emplace_back(family.names);
  }
  return join(names);
}

bool is_one_of(std::span<const std::string_view> names, std::string_view name) {
  return std::any_of(names.begin(), names.end(), [&](std::string_view known) {
    return known.ends_with('*') ? name.starts_with(known.substr(0, known.size() - 1)) : name == known;
  });
}

/// 'C' and a letter begin every element's name.
bool looks_like_an_element(std::string_view name) {
  return name.size() > 1 && name[0] == 'C' && name[1] >= 'A' && name[1] <= 'Z';
}

/// Materials and properties: they matter only where an element names them.
bool is_referred_to(std::string_view name) {
  return name.starts_with("MAT") || name.starts_with('P');
}

std::string reason_for(std::string_view name) {
  if (name.starts_with("MAT")) return "this material is not supported, only MAT1, MAT2, MAT8 and MAT9";
  if (name.starts_with("PCOMP")) return "this laminate is not supported, only PCOMP and PCOMPG";
  if (is_referred_to(name)) return "this property is not supported";
  return fmt::format("this card changes the model and is not supported; read are {}", names_of_read_cards());
}

/// How the deck may be solved all the same; empty where leaving cards out does not help.
std::string way_out(std::span<const UnreadCards> refused) {
  std::vector<std::string> names;
  for (const UnreadCards& cards : refused) {
    if (is_referred_to(cards.first->name)) return {};
    names.push_back(fmt::format("\"{}\"", cards.first->name));
  }
  return fmt::format("; model.ignore_cards = [{}] goes on without {}", join(names), names.size() > 1 ? "them" : "it");
}

/// Who needs the cards, or how many there are.
std::string use_of(const UnreadCards& cards) {
  if (!cards.user.empty()) {
    const std::string others = cards.count > 1 ? fmt::format(", as do {} more elements", cards.count - 1) : "";
    return fmt::format("; {} needs it{}", cards.user, others);
  }
  return cards.count > 1 ? fmt::format(" ({} such cards in the deck)", cards.count) : "";
}

}  // namespace

void refuse(const ModelBuilder& builder, std::vector<UnreadCards> refused) {
  if (refused.empty()) return;
  std::sort(refused.begin(), refused.end(),
            [](const UnreadCards& a, const UnreadCards& b) { return a.first < b.first; });  // as they stand in the deck
  const Card first = builder.card_of(*refused.front().first);
  if (refused.size() == 1) {
    const UnreadCards& only = refused.front();
    first.fail(fmt::format("{}{}{}", reason_for(first.name()), use_of(only), way_out(refused)));
  }
  std::vector<std::string> kinds;
  for (const UnreadCards& cards : refused) {
    const std::string where = builder.deck.location_of(*cards.first);
    kinds.push_back(cards.user.empty() ? fmt::format("{} ({}, the first at {})", cards.first->name, cards.count, where)
                                       : fmt::format("{} {} ({}{})", cards.first->name,
                                                     shown(builder.card_of(*cards.first).at(1)), where, use_of(cards)));
  }
  fail({builder.deck.files[static_cast<std::size_t>(first.bulk().file)], first.bulk().line},
       fmt::format("{} kinds of cards change the model and are not supported: {}; read are {}{}", kinds.size(),
                   join(kinds), names_of_read_cards(), way_out(refused)));
}

namespace {

/// Notes of cards that are skipped although they may matter to somebody.
void note_skipped(ModelBuilder& builder, const UnreadCards& cards) {
  const std::string_view name = cards.first->name;
  if (is_one_of(k_design_relations, name)) {
    builder.note(
        fmt::format("{} {} cards: design variables and equations (DESVAR, DEQATN) are not evaluated, the numbers "
                    "are those that stand on the cards",
                    cards.count, name));
  }
  if (is_one_of(k_harmless, name)) return;
  if (is_one_of(k_refused, name)) {
    builder.note(fmt::format("{} {} cards are not supported; no element that is read needs them", cards.count, name));
    return;
  }
  if (++builder.unknown_kinds > k_max_notes) {
    builder.count("{} further kinds of cards are not known here and were ignored");
    return;
  }
  builder.note(fmt::format("{} {} cards are not known here and were ignored, the first one at {}", cards.count,
                           shown(name), builder.deck.location_of(*cards.first)));
}

constexpr std::string_view k_matrix_commands[] = {"K2GG", "M2GG", "B2GG", "K2PP", "M2PP", "B2PP", "K42GG", "NSM"};

}  // namespace

void remember_unread(ModelBuilder& builder, const BulkCard& card) {
  int id = 0;
  if (!is_referred_to(card.name) || is_one_of(k_harmless, card.name)) return;
  if (!parse_integer(builder.card_of(card).at(1), id)) return;
  const bool is_material = card.name.starts_with("MAT");
  (is_material ? builder.unread_materials : builder.unread_properties).try_emplace(id).first->second.unread = &card;
}

std::vector<UnreadCards> find_refused_cards(ModelBuilder& builder, std::span<const UnreadCards> unread) {
  std::vector<UnreadCards> refused;
  for (const UnreadCards& cards : unread) {
    const std::string_view name = cards.first->name;
    if (is_one_of(k_superelement_cards, name)) {
      builder.card_of(*cards.first).fail("superelements are not supported; write the whole structure as one model");
    }
    const bool changes_the_model = is_one_of(k_refused, name) || looks_like_an_element(name);
    if (!is_one_of(k_harmless, name) && changes_the_model && !is_referred_to(name)) {
      refused.push_back(cards);
    } else {
      note_skipped(builder, cards);
    }
  }
  return refused;
}

void refuse_matrix_commands(ModelBuilder& builder) {
  for (const std::string_view name : k_matrix_commands) {
    const CaseCommand* command = builder.deck.find_command(name, builder.subcase);
    if (command == nullptr) continue;
    if (builder.options.ignore_cards.contains(std::string(name))) {
      builder.note(fmt::format("{} = {} was left out, as model.ignore_cards asks", name, shown(command->value)));
      continue;
    }
    fail({builder.deck.files[static_cast<std::size_t>(command->file)], command->line},
         fmt::format("{} = {}: matrices and masses that the case control section adds are not supported; "
                     "model.ignore_cards = [\"{}\"] goes on without them",
                     name, shown(command->value), name));
  }
}

}  // namespace mottle::formats::nastran
