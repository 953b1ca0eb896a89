// The datasets of a universal file that are understood, one function each; the mark and the number are passed already.
#pragma once

#include <optional>
#include <string>

#include "formats/uff/cursor.hpp"
#include "mottle/formats/uff/uff.hpp"
#include "mottle/layers.hpp"

namespace mottle::formats {

/// Whether elements of this descriptor are lines, which have a record on their orientation.
bool is_uff_line(int descriptor);

void read_uff_header(UffCursor& cursor, UffFile& out);
void read_uff_units(UffCursor& cursor, UffFile& out);
void read_uff_nodes_15(UffCursor& cursor, UffFile& out);
void read_uff_nodes_2411(UffCursor& cursor, UffFile& out);
void read_uff_systems_18(UffCursor& cursor, UffFile& out);
void read_uff_systems_2420(UffCursor& cursor, UffFile& out);
void read_uff_trace_line(UffCursor& cursor, UffFile& out);
void read_uff_elements(UffCursor& cursor, UffFile& out);
/// Results other than mode shapes at nodes are left to be skipped, with a note.
void read_uff_shape_55(UffCursor& cursor, UffFile& out);
void read_uff_shape_2414(UffCursor& cursor, UffFile& out);
/// @param binary  the rest of the line of the dataset's number, of 58b: byte order, format, lines, bytes
void read_uff_function(UffCursor& cursor, UffFile& out, const std::optional<std::string>& binary);

UffTitles read_uff_titles(UffCursor& cursor);

}  // namespace mottle::formats
