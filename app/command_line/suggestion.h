// What somebody may have meant who misspelt a word.
#pragma once

#include <string>
#include <vector>

namespace raycone {

// "; did you mean WORD?", or nothing. WORD is the one of `words` that `misspelt` is most like, the first of several: it
// begins with it, or few letters are wrong, missing, too many or swapped with their neighbours, about one in four.
// Upper case is lower case. Nothing for words of one or two letters.
[[nodiscard]] std::string suggestion(const std::string& misspelt, const std::vector<std::string>& words);

// The same for an option's value: `placeholder` is what stands for it in the help, with the words that it may be.
[[nodiscard]] std::string value_suggestion(const std::string& value, const std::string& placeholder);

}  // namespace raycone
