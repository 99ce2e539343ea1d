/* The report of the daemon about the metric of the site as text for people, and advice what would
 * make recognition better. */
#ifndef CLI_TEXT_SITE_TEXT_H
#define CLI_TEXT_SITE_TEXT_H

#include <jansson.h>
#include <stdio.h>

/* Lists what would help, as an array of texts. `site` is the reply of GetSite with the member
 * "look-alike-pairs", an array of objects "person", "other", "score" (null: this user may not know
 * them) and, if there are people of another sensor, "site-other-people", an array of their names or
 * null. `single` is an array of the names of people who have one template; NULL: not known. The
 * caller releases the result; NULL: out of memory. */
json_t *cli_site_advise(const json_t *site, const json_t *single);

/* Prints `site`, which also has the member "advice". */
void cli_site_print(const json_t *site, FILE *out);

#endif
