// Parts and instances of an Abaqus deck, and what their numbers and names become in a flat one.
#pragma once

#include <Eigen/Core>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "formats/calculix/steps.hpp"
#include "mottle/layers.hpp"

namespace mottle::formats {

/// A keyword line with its data lines.
struct AbaqusBlock {
  Keyword keyword;
  std::size_t line = 0;  ///< of the deck
  std::string text;      ///< of the keyword line
  std::vector<std::string> data = {};
};

struct Instance {
  std::string name;
  std::vector<AbaqusBlock> blocks = {};  ///< of its part, then its own
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();
  Eigen::Vector3d axis_point = Eigen::Vector3d::Zero();
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();  ///< after the translation
  bool is_turned = false;
  long long offset = 0;  ///< added to its nodes and elements
  std::set<long long> nodes = {};

  bool is_moved() const { return is_turned || !translation.isZero(0.0); }
};

struct AbaqusModel {
  std::vector<Instance> instances;
  std::vector<AbaqusBlock> model;                   ///< of the assembly and outside of it, in the deck's order
  long long offset = 0;                             ///< of the assembly's own nodes and elements
  std::set<long long> nodes = {};                   ///< the assembly's own
  std::map<std::string, std::string> single_nodes;  ///< sets of one node, by their names in the flat deck

  const Instance& instance(const CalculixDeck& deck, std::size_t line, const std::string& name) const;
  /// "SET" inside of an instance -> "INSTANCE.SET"; outside as it is.
  std::string set_name(const std::string& name, const Instance* scope) const;
  /// A node (kind n; m: it need not be there), element (e) or surface (s), by number or name, "INSTANCE.17" too.
  std::string reference(const CalculixDeck& deck, std::size_t line, const std::string& field, char kind,
                        const Instance* scope) const;
  /// The node of REF NODE, which Abaqus lets one give by a set.
  std::string reference_node(const CalculixDeck& deck, std::size_t line, const std::string& value,
                             const Instance* scope) const;
  std::vector<std::string> notes() const;
};

/// @throws FormatError  parts in parts, a part that is missing, an end that is missing
AbaqusModel read_abaqus_model(const CalculixDeck& deck, const std::vector<std::string>& lines);

}  // namespace mottle::formats
