// The optional arguments of texture functions.
#include "core/lang/checker.h"
#include "core/lang/texture_options.h"

namespace aerosol::lang {

void Checker::checkTextureOptions(Call& call) {
  auto& arguments = call.arguments;
  for (std::size_t i = call.builtin->parameters.size(); i < arguments.size(); i += 2) {
    const auto* name = std::get_if<StringLiteral>(&arguments[i]->node);
    if (!name) {
      error(arguments[i]->position, "here stands the name of an option, as a string");
      return;
    }
    const TextureOption* option = findTextureOption(name->value);
    if (!option) {
      std::vector<std::string> names;
      for (const TextureOption& known : textureOptions()) names.emplace_back(known.name);
      std::vector<std::string> notes;
      if (const std::string hint = didYouMean(name->value, names); !hint.empty()) notes.push_back(hint);
      std::string list = "the options are:";
      for (const std::string& known : names) list += " \"" + known + "\"";
      notes.push_back(list);
      advise(arguments[i]->position, "unknown option \"" + name->value + "\" of '" + call.name + "' is ignored", notes);
    }
    if (i + 1 >= arguments.size()) {
      error(arguments[i]->position, "option \"" + name->value + "\" has no value");
      return;
    }
    if (!option) continue;
    Expression& value = *arguments[i + 1];
    if (isPoisoned(value.type) || (option->isOutput() && !checkWritable(value))) continue;
    if (!option->takes(value.type)) {
      advise(value.position, "option \"" + name->value + "\" " +
                                 (option->isOutput() ? "writes a variable" : "is a value") + " of type " +
                                 toString(option->type) + ", not " + toString(value.type) + ": it is ignored");
    }
  }
}

}  // namespace aerosol::lang
