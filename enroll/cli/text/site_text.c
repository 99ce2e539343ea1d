#include "enroll/cli/text/site_text.h"

#include <string.h>

#include "drivers/terminal/terminal.h"
#include "drivers/terminal/words.h"
#include "enroll/cli/client/state.h"
#include "firmware/contract/contract.h"

/* More people with one template are counted and not named. */
enum { NAMES_MAX = 5 };

static const char *const levels[] = {ISO_CONTRACT_LEVEL_CONVENIENT, ISO_CONTRACT_LEVEL_BALANCED,
                                     ISO_CONTRACT_LEVEL_STRICT};

static bool is_site(const json_t *site, const char *word)
{
    const char *state = cli_state_text(site, "site");
    return state && strcmp(state, word) == 0;
}

/* ---- what would help ---- */

static int add_text(json_t *advice, json_t *text)
{
    return json_array_append_new(advice, text);
}

static int advise_people(json_t *advice, const json_t *site)
{
    const json_int_t people = cli_state_number(site, "site-people", 0);
    const json_int_t least = cli_state_number(site, "site-least", 0);

    return people < least ? add_text(advice, json_sprintf("enrol more people: the metric has "
                                                          "learned from %d of the %d that it needs",
                                                          (int)people, (int)least))
                          : 0;
}

/* Names the people if this user may list them, and else only counts them. */
static int advise_other_sensor(json_t *advice, const json_t *site)
{
    const json_t *names = json_object_get(site, "site-other-people");
    const size_t all = (size_t)cli_state_number(site, "site-other-sensor", 0);
    const size_t named = json_array_size(names) < NAMES_MAX ? json_array_size(names) : NAMES_MAX;
    int error = 0;

    for (size_t i = 0; !error && i < named; i++) {
        error = add_text(advice, json_sprintf("enrol %s again before this camera: another model "
                                              "has made all templates",
                                              json_string_value(json_array_get(names, i))));
    }
    return error || named >= all
               ? error
               : add_text(advice, json_sprintf("enrol %d %s again before this camera (isotherm "
                                               "enroll): another model has made all templates",
                                               (int)(all - named),
                                               named > 0 ? "more people"
                                                         : iso_plural(all, "person", "people")));
}

static int advise_poses(json_t *advice, const json_t *single)
{
    const size_t n = json_array_size(single);
    int error = 0;

    for (size_t i = 0; !error && i < n && i < NAMES_MAX; i++) {
        const char *name = json_string_value(json_array_get(single, i));
        error = add_text(advice, json_sprintf("enrol %s in poses (isotherm enroll): there is one "
                                              "template only",
                                              name));
    }
    return error || n <= NAMES_MAX
               ? error
               : add_text(advice, json_sprintf("enrol %d more people in poses: isotherm list shows "
                                               "who has one template only",
                                               (int)(n - NAMES_MAX)));
}

static int advise_look_alikes(json_t *advice, const json_t *site)
{
    const json_t *pairs = json_object_get(site, "look-alike-pairs"), *pair;
    const json_int_t n = cli_state_number(site, "look-alikes", 0);
    size_t i;
    int error = 0;

    if (!json_is_array(pairs)) {
        return n == 0 ? 0
                      : add_text(advice, json_string("let an administrator see who looks alike: "
                                                     "isotherm site"));
    }
    json_array_foreach(pairs, i, pair)
    {
        error = error
                    ? error
                    : add_text(advice, json_sprintf("%s and %s look alike: set level = strict in "
                                                    "isotherm.conf(5), or give one of them a card",
                                                    cli_state_text(pair, "person"),
                                                    cli_state_text(pair, "other")));
    }
    return error;
}

json_t *cli_site_advise(const json_t *site, const json_t *single)
{
    json_t *advice = json_array();
    int error = 0;

    if (!advice) {
        return NULL;
    }
    if (is_site(site, ISO_CONTRACT_SITE_OFF)) {
        error = add_text(advice, json_string("let the metric adapt to the people: adapt = yes in "
                                             "section match of isotherm.conf(5)"));
    } else {
        error = advise_people(advice, site);
        error = error ? error : advise_other_sensor(advice, site);
        error = error ? error : advise_poses(advice, single);
        error = error ? error : advise_look_alikes(advice, site);
    }
    if (error) {
        json_decref(advice);
        return NULL;
    }
    return advice;
}

/* ---- printing ---- */

static void print_heading(const char *heading, FILE *out)
{
    const struct iso_terminal terminal = iso_terminal_of(out);
    fprintf(out, "%s%s%s\n", iso_terminal_paint(&terminal, ISO_PAINT_HEADING), heading,
            iso_terminal_paint(&terminal, ISO_PAINT_PLAIN));
}

static void print_metric(const json_t *site, FILE *out)
{
    const json_int_t people = cli_state_number(site, "site-people", 0);
    const json_int_t taught = cli_state_number(site, "site-taught", 0);
    const json_int_t excluded = cli_state_number(site, "site-excluded", 0);
    const json_int_t other = cli_state_number(site, "site-other-sensor", 0);
    const double growth = cli_state_real(site, "site-growth");
    const char *state = cli_state_text(site, "site");

    print_heading("Metric", out);
    fprintf(out, "  %-22s %s\n", "state", state ? state : "not reported");
    if (is_site(site, ISO_CONTRACT_SITE_OFF)) {
        return;
    }
    fprintf(out, "  %-22s %d %s, %d of them with two templates or more\n", "learned from",
            (int)people, iso_plural((uint64_t)people, "person", "people"), (int)taught);
    if (other > 0) {
        fprintf(out, "  %-22s %d %s: enrolled before another model of camera\n", "do not teach it",
                (int)other, iso_plural((uint64_t)other, "person", "people"));
    }
    if (excluded > 0) {
        fprintf(out, "  %-22s %d %s not teach it any more\n", "taken back", (int)excluded,
                iso_plural((uint64_t)excluded, "template does", "templates do"));
    }
    fprintf(out, "  %-22s %.2f; rendered people have %.2f\n", "they have in common",
            cli_state_real(site, "site-offset"), cli_state_real(site, "site-expected"));
    if (growth > 0.0) {
        fprintf(out, "  %-22s %.2f times that of rendered people\n", "variance within", growth);
    }
}

/* "1.23 % [0.50, 4.00]", or "not known" without a comparison. */
static void print_rate(const json_t *site, const char *level, const char *rate, FILE *out)
{
    char key[64], text[64] = "not known";

    (void)snprintf(key, sizeof key, "%s-%s", level, rate);
    if (json_object_get(site, key)) {
        const double value = cli_state_real(site, key);
        (void)snprintf(key, sizeof key, "%s-%s-low", level, rate);
        const double low = cli_state_real(site, key);
        (void)snprintf(key, sizeof key, "%s-%s-high", level, rate);
        (void)snprintf(text, sizeof text, "%.2f %% [%.2f, %.2f]", 100.0 * value, 100.0 * low,
                       100.0 * cli_state_real(site, key));
    }
    fprintf(out, "  %-24s", text);
}

static void print_rates(const json_t *site, FILE *out)
{
    char key[64];

    print_heading("\nError rates of single templates, by the metric alone, with 95 % intervals",
                  out);
    if (!json_object_get(site, "estimate-people")) {
        fputs("  not known: the people have just changed, or nobody is enrolled\n", out);
        return;
    }
    fprintf(out, "  %-12s %-6s  %-24s  %s\n", "level", "score", "others who reach it",
            "the same person below it");
    for (size_t i = 0; i < sizeof levels / sizeof *levels; i++) {
        (void)snprintf(key, sizeof key, "%s-score", levels[i]);
        fprintf(out, "  %-12s %-6.1f", levels[i], cli_state_real(site, key));
        print_rate(site, levels[i], "fmr", out);
        print_rate(site, levels[i], "fnmr", out);
        fputc('\n', out);
    }
    fprintf(out, "  from %d comparisons of two people and %d of one person, among %d people\n",
            (int)cli_state_number(site, "estimate-others", 0),
            (int)cli_state_number(site, "estimate-same", 0),
            (int)cli_state_number(site, "estimate-people", 0));
}

static void print_look_alikes(const json_t *site, FILE *out)
{
    const json_t *pairs = json_object_get(site, "look-alike-pairs"), *pair;
    const json_int_t n = cli_state_number(site, "look-alikes", 0);
    size_t i;

    if (n == 0) {
        return;
    }
    print_heading("\nPeople who look alike", out);
    if (!json_is_array(pairs)) {
        fprintf(out, "  %d %s; their names are for those who may list people\n", (int)n,
                iso_plural((uint64_t)n, "pair", "pairs"));
        return;
    }
    json_array_foreach(pairs, i, pair)
    {
        fprintf(out, "  %.2f  %s and %s\n", cli_state_real(pair, "score"),
                cli_state_text(pair, "person"), cli_state_text(pair, "other"));
    }
}

void cli_site_print(const json_t *site, FILE *out)
{
    const json_t *advice = json_object_get(site, "advice"), *line;
    size_t i;

    print_metric(site, out);
    if (!is_site(site, ISO_CONTRACT_SITE_OFF)) {
        print_rates(site, out);
        print_look_alikes(site, out);
    }
    if (json_array_size(advice) > 0) {
        print_heading("\nWhat would help", out);
    }
    json_array_foreach(advice, i, line)
    {
        fprintf(out, "  %s\n", json_string_value(line));
    }
}
