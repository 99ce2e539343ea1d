/* Reads a member of one flat JSON object, as json_line.h writes it; used for records of the log. */
#ifndef ISO_FIRMWARE_CONTRACT_JSON_MEMBER_H
#define ISO_FIRMWARE_CONTRACT_JSON_MEMBER_H

#include <stdbool.h>
#include <stddef.h>

/* Copies the text of the member `name` from the object at the beginning of `text`. Escapes stay as
 * they are written. Returns false and leaves `value` as it was if there is no such member, if it is
 * not a text, if it needs more than `size` bytes with the NUL, or if the object is damaged before
 * it. */
bool iso_json_member(const char *text, const char *name, char *value, size_t size);

#endif
