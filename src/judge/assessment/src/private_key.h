// SPDX-License-Identifier: Apache-2.0
/// \file private_key.h  Reader of private key files.
#pragma once

#include "signing.h"
#include "trocar/assessment/signing_key.h"

namespace trocar::assessment {

/// \return kKeyInvalid where the file holds none or was damaged; kKeyLocked without its passphrase or with another; the file's
/// error, kKeyUnsafe among them
base::Result<KeySeed> ReadPrivateKey(const SigningKey& key);

}  // namespace trocar::assessment
