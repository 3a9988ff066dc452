#include "comm/round.hpp"
// a { in a comment, and '{' in a string, open nothing
inline const char* brace() { return "{ '{'"; }
