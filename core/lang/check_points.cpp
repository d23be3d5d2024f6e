// Arguments of pointcloud_search and pointcloud_get behind the fixed ones: names of attributes and where to put them.
#include "core/lang/checker.h"

namespace aerosol::lang {

void Checker::checkPointOutputs(Call& call) {
  auto& arguments = call.arguments;
  std::size_t first = call.builtin->parameters.size();
  const bool maySort = call.name == "pointcloud_search";
  if (maySort && first < arguments.size() && arguments[first]->type == types::integer) ++first;
  if ((arguments.size() - first) / 2 > maximumPointOutputs) {
    error(arguments[first]->position,
          "'" + call.name + "' takes at most " + std::to_string(maximumPointOutputs) + " attributes");
    return;
  }
  for (std::size_t i = first; i < arguments.size(); i += 2) {
    if (!(arguments[i]->type == types::string) && !isPoisoned(arguments[i]->type)) {
      error(arguments[i]->position, "here stands the name of an attribute, as a string");
      return;
    }
    if (i + 1 >= arguments.size()) {
      error(arguments[i]->position, "the attribute has no array to be put into");
      return;
    }
    Expression& data = *arguments[i + 1];
    const Type element = data.type.isArray() ? data.type.element() : data.type;
    if (!checkWritable(data) || isPoisoned(data.type)) continue;
    if (element.closure || element.base == BaseType::structure)
      error(data.position, "an attribute's values are not of type " + toString(data.type));
  }
}

}  // namespace aerosol::lang
