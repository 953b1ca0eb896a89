// The keys of [model] of kind "umbridge".
#pragma once

#include "mottle/drivers/umbridge/umbridge_server.hpp"
#include "mottle/layers.hpp"
#include "study/input/toml_reader.hpp"

namespace mottle::study {

UmbridgeServer read_umbridge(TomlReader& reader);

}  // namespace mottle::study
