/* A policy as one JSON document: what people write, what the appliance stores, and what programs
 * exchange. The terms are ONVIF's (policy.h). isotherm-policy(5) describes the format for people,
 * with an example; this is the complete description.
 *
 *   JSON text --iso_policy_document_read--> struct iso_policy_document --policy--> decide.h
 *        ^                                          |
 *        '--------iso_policy_document_write---------'
 *
 * The document is one JSON object (RFC 8259, UTF-8). Each member is optional. "..." stands for a
 * text, and a text after the name of another kind of record is the token of such a record, which
 * may come earlier or later in the document.
 *
 *   {
 *     "special_day_groups": [
 *       {"token": "...",
 *        "days": ["2026-12-25", ...]}              any order, no date twice; years 1970 to 9999
 *     ],
 *     "schedules": [
 *       {"token": "...",
 *        "zone": "Europe/Berlin",                  required: a name of the IANA zones
 *        "weekly": {                               a day that is not named has no hours
 *          "monday-friday": ["09:00-17:30", ...],  a day, or a range of days, which may pass the
 *          "saturday": []},                        end of the week; no day twice
 *        "special_days": [                         on these days these hours replace the weekly
 *          {"group": "...",                        ones; required
 *           "hours": ["10:00-12:00"]}]}            not given: no hours
 *     ],
 *     "areas": [{"token": "..."}],
 *     "security_levels": [
 *       {"token": "...",
 *        "priority": 10,                           higher is stricter; not given: 1 for the first
 *                                                  level of the list, 2 for the second, ...
 *        "recognition_groups": [["face"], ["card", "pin"]],   all methods of one group are needed
 *        "open": true}                             lets everybody in; without this and without
 *     ],                                           groups the level is closed
 *     "authentication_profiles": [
 *       {"token": "...",
 *        "default_level": "...",                   required: where no policy asks for a level
 *        "policies": [
 *          {"schedule": "...",                     required
 *           "active": {"level": "...",             while the schedule is active; a state that is
 *                      "two_people": true},        not given asks for nothing
 *           "inactive": {...},                     while it is not active
 *           "special_active": {...},               the same two on special days; not given: as on
 *           "special_inactive": null}]}            other days; null: asks for nothing
 *     ],
 *     "access_points": [
 *       {"token": "...",
 *        "enabled": true,                          not given: true
 *        "from": "...", "to": "...",               areas; not given: none
 *        "authentication_profile": "...",          not given: "face", see below
 *        "antipassback": "timed",                  or "none" (the default), "soft", "hard"
 *        "antipassback_s": 600}                    seconds; with "timed" alone
 *     ],
 *     "access_profiles": [
 *       {"token": "...",
 *        "policies": [{"access_point": "...", "schedule": "..."}, ...]}        both required
 *     ],
 *     "default_profile": "..."                     the access profile of people who name none
 *   }
 *
 * A token has 1 to 64 bytes without control characters. It is unique among the records of its kind;
 * capital and small letters are different. A period "09:00-17:30" begins at its first minute and
 * ends before its last; "24:00" is the end of a day. Periods of a day ascend, do not overlap and do
 * not pass midnight: what passes midnight is two periods. The number of entries in a record is
 * limited by policy.h.
 *
 * An access point that names no authentication profile has the profile "face". If the document has
 * no profile of this token, the reader adds one, whose default level is the security level "face".
 * If there is no such level either, it adds one that needs a face and has the lowest free priority
 * from 0 on. So a small policy needs neither levels nor profiles: a face is enough at any time. */
#ifndef ISO_FIRMWARE_POLICY_DOCUMENT_POLICY_DOCUMENT_H
#define ISO_FIRMWARE_POLICY_DOCUMENT_POLICY_DOCUMENT_H

#include <stddef.h>
#include <stdint.h>

#include "firmware/policy/policy.h"
#include "isotherm/fault.h"

enum {
    ISO_POLICY_DOCUMENT_MAX_BYTES = 1 << 20,
    ISO_POLICY_DOCUMENT_MAX_DEPTH = 16,    /* arrays and objects within each other */
    ISO_POLICY_DOCUMENT_MAX_RECORDS = 4096 /* of each kind */
};

/* A policy that was read, with all its arrays. It has no credentials: these are stored with the
 * people. */
struct iso_policy_document;

/* Where the reader gets time zones from. `read` fills *out, whose name becomes `name`, and returns
 * 0; or it returns a negative errno with a line in *fault, which is not NULL. `name` is any text of
 * the document that fits into struct iso_zone. Each zone is read once for a document. */
struct iso_zone_source {
    int (*read)(void *context, const char *name, struct iso_zone *out, struct iso_fault *fault);
    void *context;
};

/* Reads a document of `size` bytes. The caller frees *out with iso_policy_document_free(). What it
 * returns has passed iso_policy_validate().
 *
 *   -EINVAL   the document is refused. The line names the record and the fault, such as
 *                 schedule "office": monday: "9:00-17:30" is not a period such as "09:00-17:30"
 *                 access profile "staff": there is no access point "fornt"
 *             Refused are: what is not JSON, too large or too deep; an unknown or repeated member;
 *             a value of another type; a token that is missing, unfit or used twice; a token that
 *             no record has; a zone that cannot be read; and what iso_policy_validate() refuses.
 *   -ENOMEM   no memory */
int iso_policy_document_read(const char *json, size_t size, const struct iso_zone_source *zones,
                             struct iso_policy_document **out, struct iso_fault *fault);

/* The policy. It lives as long as the document. credentials is NULL and n_credentials is 0; a
 * caller who has credentials copies the struct and sets both. */
const struct iso_policy *iso_policy_document_policy(const struct iso_policy_document *document);

/* Frees the document. NULL is accepted. */
void iso_policy_document_free(struct iso_policy_document *document);

/* Writes the document as canonical JSON: compact, members in the order above, records in the order
 * of the document, nothing that is as by default, except that priorities, zones and authentication
 * profiles are always written. The same policy gives the same bytes, and reading these gives the
 * same policy again. The caller frees *json, which ends with a zero byte, with free().
 *
 *   -E2BIG    the text would be longer than a document may be
 *   -ENOMEM   no memory */
int iso_policy_document_write(const struct iso_policy_document *document, char **json,
                              struct iso_fault *fault);

/* The index of the access point or access profile of a token, or ISO_INDEX_NONE. */
uint16_t iso_policy_document_access_point(const struct iso_policy_document *document,
                                          const char *token);
uint16_t iso_policy_document_access_profile(const struct iso_policy_document *document,
                                            const char *token);

/* The access profile of people who name none, or ISO_INDEX_NONE. */
uint16_t iso_policy_document_default_profile(const struct iso_policy_document *document);

/* Calls `each` for each record that was removed or changed, in the order of `before`, and then for
 * each that was added, in the order of `after`; one kind after another. Either document may be
 * NULL, which is one without records.
 *
 *   kind          "special_day_group", "schedule", "area", "security_level",
 *                 "authentication_profile", "access_point", "access_profile", "default_profile"
 *   token         of the record; "" for the default profile
 *   before_json   the record as canonical JSON (of the default profile: its token as a JSON
 *                 string); "" if it was added
 *   after_json    the same; "" if it was removed
 *
 * The order of records alone is no change. If `each` returns something other than 0, the comparison
 * ends and returns it. Returns 0 at the end, or -ENOMEM. */
int iso_policy_document_compare(const struct iso_policy_document *before,
                                const struct iso_policy_document *after,
                                int (*each)(void *context, const char *kind, const char *token,
                                            const char *before_json, const char *after_json),
                                void *context);

#endif
