// The user's files that a run reads.
#pragma once

#include <string>
#include <vector>

#include "plan/plan.hpp"
#include "study/study.hpp"

namespace koksma {

// {path: hash of the text}, null where there are none: they decide results too, so cells measured
// with other contents are not taken over. `integrands`: entries, each with its .cl beside it;
// `directions`: "" for none.
Json input_files(const Catalog& catalog, const Study& study,
                 const std::vector<std::string>& integrands, const std::string& directions);

// InputError for a file of direction numbers that is wrong, or that no sampler of the study reads,
// before anything is built or run.
void check_directions(const Catalog& catalog, const Study& study, const std::string& directions);

// The same for files that samplers name: planning reads them.
void check_sampler_files(const Catalog& catalog, const Study& study, const DeviceFacts& device);

}  // namespace koksma
