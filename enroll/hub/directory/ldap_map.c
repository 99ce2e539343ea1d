#include "enroll/hub/directory/ldap_map.h"

#include <ctype.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <time.h>

#define TICKS_PER_S     10000000LL
#define S_FROM_1601     11644473600LL
#define DISABLED_BIT_AD 2

/* The member of a map that a word names; NULL: there is none. */
static char *member(struct hub__ldap_map *map, const char *word, size_t length)
{
    const struct {
        const char *word;
        char *member;
    } members[] = {{"id", map->id},       {"name", map->name},
                   {"group", map->group}, {"disabled", map->disabled},
                   {"from", map->from},   {"until", map->until}};
    for (size_t i = 0; i < sizeof members / sizeof *members; i++) {
        if (strlen(members[i].word) == length && strncmp(members[i].word, word, length) == 0) {
            return members[i].member;
        }
    }
    return NULL;
}

static bool is_attribute(const char *text, size_t length)
{
    for (size_t i = 0; i < length; i++) {
        if (!isalnum((unsigned char)text[i]) && !strchr("-;._", text[i])) {
            return false;
        }
    }
    return length > 0 && length < HUB__ATTRIBUTE_SIZE;
}

int hub__ldap_map_read(const char *text, struct hub__ldap_map *out, struct iso_fault *fault)
{
    struct hub__ldap_map map = {.id = "entryUUID", .name = "cn", .group = "memberOf"};
    for (const char *at = text && *text ? text : NULL; at;) {
        const size_t length = strcspn(at, ","), word = strcspn(at, "=");
        char *to = word < length ? member(&map, at, word) : NULL;
        if (!to || !is_attribute(at + word + 1, length - word - 1)) {
            return iso_fault_set(fault, -EINVAL,
                                 "'%.*s' is none of id=, name=, group=, disabled=, from= and "
                                 "until= with an attribute",
                                 (int)length, at);
        }
        (void)snprintf(to, HUB__ATTRIBUTE_SIZE, "%.*s", (int)(length - word - 1), at + word + 1);
        at = at[length] ? at + length + 1 : NULL;
    }
    *out = map;
    return 0;
}

int hub__ldap_id(const void *bytes, size_t size, char out[HUB_EXTERNAL_SIZE])
{
    const unsigned char *at = bytes;
    bool is_text = true;
    for (size_t i = 0; i < size; i++) {
        is_text = is_text && at[i] > ' ' && at[i] < 0x7f;
    }
    if (size == 0 || (is_text ? size : 2 * size) >= HUB_EXTERNAL_SIZE) {
        return -EINVAL;
    }
    if (is_text) {
        (void)snprintf(out, HUB_EXTERNAL_SIZE, "%.*s", (int)size, (const char *)bytes);
    } else {
        for (size_t i = 0; i < size; i++) {
            (void)snprintf(out + 2 * i, HUB_EXTERNAL_SIZE - 2 * i, "%02x", at[i]);
        }
    }
    return 0;
}

bool hub__ldap_is_group(const char *value, const char *group)
{
    const char *begin = strchr(value, '=');
    if (strcasecmp(value, group) == 0) {
        return true;
    }
    const size_t length = begin ? strcspn(begin + 1, ",+") : 0;
    return length > 0 && strlen(group) == length && strncasecmp(begin + 1, group, length) == 0;
}

bool hub__ldap_is_disabled(const char *attribute, const char *value)
{
    if (strcasecmp(attribute, "userAccountControl") == 0) {
        return strtoull(value, NULL, 10) & DISABLED_BIT_AD;
    }
    return *value && strcasecmp(value, "FALSE") != 0 && strcmp(value, "0") != 0;
}

static int generalized(const char *text, int64_t *out)
{
    struct tm utc = {0};
    const char *rest = strlen(text) >= 15 ? strptime(text, "%Y%m%d%H%M%S", &utc) : NULL;
    if (rest && *rest == '.') {
        rest += 1 + strspn(rest + 1, "0123456789");
    }
    const int64_t time_s = rest && strcmp(rest, "Z") == 0 ? timegm(&utc) : -1;
    if (time_s <= 0) {
        return -EINVAL;
    }
    *out = time_s;
    return 0;
}

int hub__ldap_time(const char *text, int64_t *out)
{
    if (text[strspn(text, "0123456789")] || !*text) {
        return generalized(text, out);
    }
    errno = 0;
    const long long ticks = strtoll(text, NULL, 10);
    if (errno) {
        return -EINVAL;
    }
    if (ticks == 0 || ticks == INT64_MAX) {
        *out = 0;
        return 0;
    }
    if (ticks / TICKS_PER_S <= S_FROM_1601) {
        return -EINVAL;
    }
    *out = ticks / TICKS_PER_S - S_FROM_1601;
    return 0;
}
