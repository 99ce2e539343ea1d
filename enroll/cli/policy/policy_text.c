#include "enroll/cli/policy/policy_text.h"

#include <string.h>

#include "drivers/terminal/columns.h"
#include "firmware/policy/document/day_text.h"

enum { TOKEN_COLUMNS = 20 };

static const char *const weekdays[7] = {"Sunday",   "Monday", "Tuesday", "Wednesday",
                                        "Thursday", "Friday", "Saturday"};

void cli_policy_methods_text(unsigned methods, char text[CLI_METHODS_SIZE])
{
    static const char *const words[] = {"face", "card", "PIN"};

    text[0] = '\0';
    for (unsigned i = 0; i < 3; i++) {
        if ((methods >> i & 1) != 0) {
            const bool is_last = methods >> (i + 1) == 0;
            (void)strcat(text, !text[0] ? "" : is_last ? " and " : ", ");
            (void)strcat(text, words[i]);
        }
    }
}

/* Begins a line: two blanks and the token, or as many blanks if it is "". */
static void begin(FILE *out, const char *token)
{
    fputs("  ", out);
    iso_columns_print(out, token, TOKEN_COLUMNS);
    fputc(' ', out);
}

static void print_token(FILE *out, const char *token)
{
    iso_columns_print(out, token, 0);
}

static void print_hours(FILE *out, const struct iso_day_hours *hours)
{
    for (int i = 0; i < hours->n; i++) {
        char text[ISO_PERIOD_TEXT_SIZE];
        iso_period_write(&hours->periods[i], text);
        fprintf(out, "%s%s", i ? ", " : "", text);
    }
    fputs(hours->n == 0 ? "closed\n" : "\n", out);
}

static bool is_same(const struct iso_day_hours *a, const struct iso_day_hours *b)
{
    return a->n == b->n && memcmp(a->periods, b->periods, a->n * sizeof *a->periods) == 0;
}

/* From Monday to Sunday; days without hours are left out. */
static void print_schedule(FILE *out, const struct iso_policy *policy,
                           const struct iso_schedule *schedule)
{
    begin(out, schedule->token);
    fprintf(out, "%s\n", policy->zones[schedule->zone].name);
    for (int i = 0; i < 7;) {
        const int first = (i + 1) % 7;
        int last = first;
        for (i++; i < 7 && is_same(&schedule->weekly[first], &schedule->weekly[(i + 1) % 7]); i++) {
            last = (i + 1) % 7;
        }
        if (schedule->weekly[first].n > 0) {
            begin(out, "");
            fprintf(out, "%s%s%s ", weekdays[first], first == last ? "" : " to ",
                    first == last ? "" : weekdays[last]);
            print_hours(out, &schedule->weekly[first]);
        }
    }
    for (int i = 0; i < schedule->n_special; i++) {
        begin(out, "");
        fputs("on ", out);
        print_token(out, policy->groups[schedule->special[i].group].token);
        fputs(": ", out);
        print_hours(out, &schedule->special[i].hours);
    }
}

static void print_level(FILE *out, const struct iso_security_level *level)
{
    if (level->n_groups == 0) {
        fputs(level->open ? "open to everybody" : "closed", out);
    }
    for (int g = 0; g < level->n_groups; g++) {
        char methods[CLI_METHODS_SIZE];
        cli_policy_methods_text(level->groups[g], methods);
        fprintf(out, "%s%s", g ? ", or " : "", methods);
    }
}

static void print_authentication(FILE *out, const struct iso_policy *policy,
                                 const struct iso_authentication_profile *profile)
{
    static const char *const states[ISO_SCHEDULE_STATES] = {
        [ISO_SCHEDULE_INACTIVE] = "not in ",
        [ISO_SCHEDULE_ACTIVE] = "in ",
        [ISO_SCHEDULE_SPECIAL] = "on special days, not in ",
        [ISO_SCHEDULE_SPECIAL_ACTIVE] = "on special days, in "};

    begin(out, "");
    print_level(out, &policy->levels[profile->default_level]);
    fputc('\n', out);
    for (int p = 0; p < profile->n_policies; p++) {
        const struct iso_authentication_policy *part = &profile->policies[p];
        for (int s = 0; s < ISO_SCHEDULE_STATES; s++) {
            const struct iso_level_constraint *c = &part->constraints[s];
            /* A special day is named only where it differs from other days. */
            const struct iso_level_constraint *usual = s >= ISO_SCHEDULE_SPECIAL
                                                           ? &part->constraints[s - 2]
                                                           : NULL;
            if (usual ? c->level == usual->level && c->dual == usual->dual
                      : c->level == ISO_INDEX_NONE) {
                continue;
            }
            begin(out, "");
            fputs(states[s], out);
            print_token(out, policy->schedules[part->schedule].token);
            fputs(": ", out);
            if (c->level == ISO_INDEX_NONE) {
                fputs("as at other times", out);
            } else {
                print_level(out, &policy->levels[c->level]);
            }
            fputs(c->dual ? ", two people\n" : "\n", out);
        }
    }
}

static void print_point(FILE *out, const struct iso_policy *policy,
                        const struct iso_access_point *point)
{
    static const char *const antipassback[] = {"", "soft", "hard", "timed"};

    begin(out, point->token);
    if (!point->enabled) {
        fputs("out of service, ", out);
    }
    fputs("from ", out);
    print_token(out, point->from == ISO_INDEX_NONE ? "anywhere" : policy->areas[point->from].token);
    fputs(" to ", out);
    print_token(out, point->to == ISO_INDEX_NONE ? "anywhere" : policy->areas[point->to].token);
    if (point->antipassback != ISO_ANTIPASSBACK_NONE) {
        fprintf(out, ", %s antipassback", antipassback[point->antipassback]);
    }
    if (point->antipassback == ISO_ANTIPASSBACK_TIMED) {
        fprintf(out, " of %d s", point->antipassback_s);
    }
    fputc('\n', out);
    print_authentication(out, policy,
                         &policy->authentication_profiles[point->authentication_profile]);
}

static void print_profile(FILE *out, const struct iso_policy *policy,
                          const struct iso_access_profile *profile, bool is_default)
{
    begin(out, profile->token);
    if (is_default) {
        fputs("the profile of people who name none\n", out);
    } else if (profile->n_policies == 0) {
        fputs("no doors\n", out);
    }
    for (int i = 0; i < profile->n_policies; i++) {
        if (i > 0 || is_default) {
            begin(out, "");
        }
        print_token(out, policy->access_points[profile->policies[i].access_point].token);
        fputs(" in ", out);
        print_token(out, policy->schedules[profile->policies[i].schedule].token);
        fputc('\n', out);
    }
}

static void print_group(FILE *out, const struct iso_special_day_group *group)
{
    enum { PER_LINE = 4 };

    for (int i = 0; i < group->n || i == 0; i += PER_LINE) {
        begin(out, i == 0 ? group->token : "");
        for (int d = i; d < group->n && d < i + PER_LINE; d++) {
            char date[ISO_DATE_TEXT_SIZE];
            iso_date_write(group->days[d], date);
            fprintf(out, "%s%s", d == i ? "" : ", ", date);
        }
        fputc('\n', out);
    }
}

void cli_policy_print(const struct iso_policy *policy, uint16_t default_profile, FILE *out)
{
    fputs(policy->n_access_points ? "Access points\n" : "", out);
    for (uint16_t i = 0; i < policy->n_access_points; i++) {
        print_point(out, policy, &policy->access_points[i]);
    }
    fputs(policy->n_access_profiles ? "Access profiles\n" : "", out);
    for (uint16_t i = 0; i < policy->n_access_profiles; i++) {
        print_profile(out, policy, &policy->access_profiles[i], i == default_profile);
    }
    fputs(policy->n_schedules ? "Schedules\n" : "", out);
    for (uint16_t i = 0; i < policy->n_schedules; i++) {
        print_schedule(out, policy, &policy->schedules[i]);
    }
    fputs(policy->n_groups ? "Special days\n" : "", out);
    for (uint16_t i = 0; i < policy->n_groups; i++) {
        print_group(out, &policy->groups[i]);
    }
}
