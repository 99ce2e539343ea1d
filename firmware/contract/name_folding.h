/* The common form of all spellings of a name. The daemon and its clients fold names in the same
 * way, so that a client finds the same person as the daemon. */
#ifndef ISO_FIRMWARE_CONTRACT_NAME_FOLDING_H
#define ISO_FIRMWARE_CONTRACT_NAME_FOLDING_H

#include <stdbool.h>
#include <stdint.h>

/* Whether folding drops this character: the Unicode properties Default_Ignorable_Code_Point and
 * Bidi_Control. A font may show nothing for it. */
bool iso_name_folding_drops(uint32_t character);

/* The compatibility caseless match of the Unicode standard (section 3.13, D146): two spellings are
 * one name if their folded texts are the same. Case, the encoding of a character (composed or
 * decomposed accents, full-width letters) and dropped characters (D147) make no difference. The
 * caller frees *out. -EINVAL the name is not UTF-8, -ENOMEM. */
int iso_name_fold(const char *name, char **out) __attribute__((warn_unused_result));

#endif
