// places [spans|frusta|overlap|lookups|priorities]: the tables of this folder, all of them or one.
#include <fmt/format.h>

#include <string_view>
#include <utility>

#include "tests/bench/places/tables.h"

int main(int count, char** arguments) {
  using namespace aerosol::bench;
  const std::pair<std::string_view, void (*)()> tables[] = {{"spans", printSpans},
                                                            {"frusta", printFrusta},
                                                            {"overlap", printOverlap},
                                                            {"lookups", printLookups},
                                                            {"priorities", printPriorities}};
  const std::string_view wanted = count > 1 ? arguments[1] : "";
  bool any = false;
  for (const auto& [name, print] : tables) {
    if (!wanted.empty() && wanted != name) continue;
    print();
    any = true;
  }
  if (!any) fmt::print(stderr, "there is no table '{}'\n", wanted);
  return any ? 0 : 2;
}
