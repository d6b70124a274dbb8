// Ready studies: the templates embedded from harness/study/studies/. A template is a study whose
// scenes may also be written "class:NAME" (every integrand of that smoothness class, at its
// default dimension and parameters) or "class:*"; written out, these are the scenes themselves, so
// that a study names what it runs.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "catalog/catalog.hpp"

namespace koksma {

struct StudyTemplate {
  std::string name, title;
};

// In alphabetical order.
std::vector<StudyTemplate> study_templates();

// The study of that name, its classes resolved. InputError("koksma study", …) with the nearest
// name.
Json ready_study(const Catalog& catalog, std::string_view name);

}  // namespace koksma
