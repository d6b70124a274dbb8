// Takes out of a composed program what cannot run: branches of #if that its defines close, and
// functions and macros that the kernel does not reach. The pieces are written for every plan; after
// this the text of a cell's program is what the cell needs and no more. The compiler would drop the
// same code, so no value changes; #line directives keep its messages on the readers' files.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace koksma {

// A function or a whole piece that was in the composed text and is not in the pruned one.
struct DroppedCode {
  std::string name;  // of the function; empty: all of the piece
  std::string path;  // of the piece
  std::size_t bytes = 0;
};

struct PrunedText {
  std::string text;
  std::vector<DroppedCode> dropped;   // in the order of the text
  std::size_t bytes_of_branches = 0;  // of closed #if branches, comments included
};

// Branches are decided where their condition holds integers and KOKSMA_* names only: those names
// are defined in the text or not at all. Others (the compiler's own) stay, with all that they
// guard. `text` is what compose puts together: defines, then pieces behind `#line 1 "<path>"`.
// Functions are dropped where they are written `static [inline] <type> <name>(...)` and their name
// (or a name pasted from its beginning) is in nothing that stays. The defines before the first
// piece stay: they say what the program is.
PrunedText pruned(const std::string& text);

// Only the first step: closed branches are taken out.
std::string without_closed_branches(const std::string& text);

}  // namespace koksma
