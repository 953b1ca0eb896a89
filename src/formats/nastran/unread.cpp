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
    "FORCE*",  "MOMENT*", "PLOAD*",  "LOAD*",   "GRAV",    "RFORCE*", "TEMP*",  "DEFORM",  "ACCEL*",  "SPCD",
    "DAREA",   "DPHASE",  "DELAY",   "DLOAD",   "RLOAD*",  "TLOAD*",  "LSEQ",   "TABLE*",  "TABD*",   "TABR*",
    "FREQ*",   "TSTEP*",  "TF",      "TIC",     "EIGC*",   "EIGB",    "EIGP",   "NOLIN*",  "RANDPS",  "RANDT1",
    "SET*",    "PLOTEL*", "DES*",    "DV*",     "DRESP*",  "DCON*",   "DEQATN", "DOPTPRM", "DLINK",   "DSCREEN",
    "DTABLE*", "DDVAL",   "DMI",     "DTI",     "AERO*",   "AE*",     "CAERO*", "PAERO*",  "SPLINE*", "MKAERO*",
    "FLUTTER", "FLFACT",  "TRIM*",   "GUST",    "CSSCHD",  "MAT4",    "MAT5",   "MATT*",   "MATS*",   "MATHE",
    "CHBDY*",  "CONV*",   "PCONV*",  "PHBDY",   "QBDY*",   "QHBDY",   "QVECT",  "QVOL",    "RADBC",   "RADM*",
    "RADSET",  "VIEW*",   "CBARAO",  "NLPARM",  "NLPCI",   "NSM",     "NSM1",   "NSML*",   "NSMADD",  "SEQGP",
    "SPCOFF*", "CLOAD*",  "CREEP",   "CAMPBLL", "CNGRET",  "DMIG*",   "MDLPRM", "FBADLAY", "BOUTPUT", "SUPORT1",
    "QSET*",   "OUTPUT",  "PANEL",   "SWLDPRM", "MONPNT*", "POINT",   "GMCURV", "FEEDGE",  "FEFACE",  "PSET",
    "PVAL",    "ECHOON",  "ECHOOFF", "USET*",   "CSET*",   "BSET*",   "ASET*",  "OMIT*",   "SUPORT",
};

/// Those of the harmless ones of which the user is informed.
constexpr std::string_view k_reductions[] = {"ASET*", "OMIT*", "CSET*", "BSET*", "QSET*", "SUPORT*"};

constexpr int k_max_notes = 30;

/// Everything else that changes stiffness, mass or constraints, besides names that resemble elements.
constexpr std::string_view k_refused[] = {
    "MAT2",    "MAT3",    "MAT8",    "MAT9",    "MAT10",   "MAT11",  "MATG",    "MATHP",  "MATORT*", "MATF",
    "RBE1",    "RROD",    "RTRPLT*", "RSPLINE", "RJOINT",  "RSSCON", "RBE2GS",  "RBE2F",  "GENEL",   "PCOMP*",
    "PLPLANE", "PLSOLID", "PBCOMP",  "PBMSECT", "PBRSECT", "PBEAM3", "PBEND",   "PSHLN*", "PSLDN1",  "SPCAX",
    "MPCAX",   "RINGAX",  "GRIDB",   "GRIDF",   "SECTAX",  "SEBULK", "SECONCT", "SEELT",  "RELEASE"};

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

std::string reason_for(std::string_view name) {
  if (name.starts_with("MAT")) return "only isotropic materials (MAT1) are supported";
  if (name.starts_with("PCOMP")) return "composite shells are not supported, only PSHELL with MAT1";
  if (name.starts_with("PB") || name.starts_with("PL") || name.starts_with("PS"))
    return "this property is not supported";
  return fmt::format("this card changes the model and is not supported; read are {}", names_of_read_cards());
}

constexpr std::string_view k_matrix_commands[] = {"K2GG", "M2GG", "B2GG", "K2PP", "M2PP", "B2PP", "K42GG", "NSM"};

}  // namespace

void handle_unread_card(ModelBuilder& builder, const Card& first, int count) {
  const std::string_view name = first.name();
  if (is_one_of(k_harmless, name)) {
    if (is_one_of(k_reductions, name)) {
      builder.note(fmt::format("{} {} cards: no reduction is made, all degrees of freedom stay", count, name));
    }
    return;
  }
  if (is_one_of(k_refused, name) || looks_like_an_element(name)) {
    const std::string others = count > 1 ? fmt::format(" ({} such cards in the deck)", count) : std::string();
    first.fail(fmt::format("{}{}; model.ignore_cards = [\"{}\"] goes on without it", reason_for(name), others, name));
  }
  if (++builder.unknown_kinds > k_max_notes) {
    builder.count("{} further kinds of cards are not known here and were ignored");
    return;
  }
  builder.note(fmt::format("{} {} cards are not known here and were ignored, the first one at {}", count, shown(name),
                           first.location()));
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
