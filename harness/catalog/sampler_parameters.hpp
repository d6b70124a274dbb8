// What may follow a sampler's name: NAME:key=value,key=value.
#pragma once

#include <string_view>

#include "catalog/catalog.hpp"

namespace koksma {

// Applies `text`, "" or ":key=value,…", to the sampler: an entry's parameter becomes an option of
// the table builder, randomize=rotate makes a deterministic set a randomized one (R. Cranley and T.
// N. L. Patterson, SIAM J. Numer. Anal. 13 (1976)). Its name becomes the canonical spelling.
// InputError for an unknown key, a value that is not allowed, a key given twice and a required one
// that is missing.
void set_parameters(Sampler& sampler, std::string_view text, std::string_view where);

}  // namespace koksma
