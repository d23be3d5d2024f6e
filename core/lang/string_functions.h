// The language's functions of strings, as host functions. Characters are bytes.
#pragma once

#include "core/lang/host_call.h"

namespace aerosol::lang {

void concatFunction(HostCall& call);       ///< string (string …)
void lengthFunction(HostCall& call);       ///< int (string)
void startsWithFunction(HostCall& call);   ///< int (string, string)
void endsWithFunction(HostCall& call);     ///< int (string, string)
void toIntFunction(HostCall& call);        ///< int (string)
void toFloatFunction(HostCall& call);      ///< float (string)
void substringFunction(HostCall& call);    ///< string (string, int [, int])
void characterFunction(HostCall& call);    ///< int (string, int)
void hashFunction(HostCall& call);         ///< int (string)
void splitFunction(HostCall& call);        ///< int (string, output string[] [, string [, int]])
void formatFunction(HostCall& call);       ///< string (string, any …)
void regexSearchFunction(HostCall& call);  ///< int (string, [output int[],] string); of a malformed expression 0
void regexMatchFunction(HostCall& call);   ///< The same for the whole string.

/// string (string text, string closure, color weight, any …): the text with a closure and its parameters added, when
/// the weight is not zero, as printf shows closures.
void addClosureTextFunction(HostCall& call);

}  // namespace aerosol::lang
