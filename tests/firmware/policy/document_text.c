#include "tests/firmware/policy/document_text.h"

#include <stdbool.h>
#include <stdio.h>
#include <string.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "firmware/policy/calendar.h"

static const struct iso_policy *w; /* what is written */
static FILE *out;
static bool first; /* of the entries of a list or an object */
static uint64_t state_bits = 5;

uint32_t document_text_draw(uint32_t n)
{
    state_bits = state_bits * 6364136223846793005U + 1442695040888963407U;
    return (uint32_t)(state_bits >> 33) % n;
}

static uint32_t draw(uint32_t n)
{
    return document_text_draw(n);
}

static bool chance(uint32_t percent)
{
    return draw(100) < percent;
}

static void next(const char *open)
{
    (void)fprintf(out, "%s%s%s", first ? "" : ",", chance(20) ? "\n " : "", open);
    first = false;
}

static void begin(char bracket)
{
    (void)fputc(bracket, out);
    first = true;
}

static void end(char bracket)
{
    (void)fputc(bracket, out);
    first = false;
}

static void text(const char *string)
{
    (void)fputc('"', out);
    for (const char *c = string; *c; c++) {
        if (*c == '"' || *c == '\\' || (*c == '/' && chance(50))) {
            (void)fputc('\\', out);
        }
        if (*c == 'a' && chance(50)) {
            (void)fputs("\\u0061", out);
        } else {
            (void)fputc(*c, out);
        }
    }
    (void)fputc('"', out);
}

static void member(const char *name)
{
    next("");
    text(name);
    (void)fputc(':', out);
}

static void member_text(const char *name, const char *value)
{
    member(name);
    text(value);
}

static void write_hours(const struct iso_day_hours *hours)
{
    begin('[');
    for (int i = 0; i < hours->n; i++) {
        const struct iso_period *p = &hours->periods[i];
        next("");
        (void)fprintf(out, "\"%02d:%02d-%02d:%02d\"", p->from_min / 60, p->from_min % 60,
                      p->to_min / 60, p->to_min % 60);
    }
    end(']');
}

static void write_groups(void)
{
    for (int g = 0; g < w->n_groups; g++) {
        const struct iso_special_day_group *group = &w->groups[g];
        next("{");
        first = true;
        member_text("token", group->token);
        member("days");
        begin('[');
        const int shift = group->n > 0 ? (int)draw(group->n) : 0;
        for (int i = 0; i < group->n; i++) {
            const int64_t day = group->days[(i + shift) % group->n];
            int64_t year = iso_calendar_year(day), rest = day - iso_calendar_year_day(year);
            int month = 1;
            for (; rest >= iso_calendar_month_days(year, month); month++) {
                rest -= iso_calendar_month_days(year, month);
            }
            next("");
            (void)fprintf(out, "\"%04d-%02d-%02d\"", (int)year, month, (int)rest + 1);
        }
        end(']');
        end('}');
    }
}

static const char *const weekdays[] = {"sunday",   "monday", "tuesday", "wednesday",
                                       "thursday", "friday", "saturday"};

/* Some equal days as a range, from any day on. */
static void write_weekly(const struct iso_schedule *schedule)
{
    begin('{');
    const int start = (int)draw(7);
    for (int i = 0; i < 7;) {
        const int from = (start + i) % 7;
        int to = from;
        for (i++; i < 7 && chance(80); i++) {
            if (memcmp(&schedule->weekly[from], &schedule->weekly[(start + i) % 7],
                       sizeof schedule->weekly[from]) != 0) {
                break;
            }
            to = (start + i) % 7;
        }
        if (schedule->weekly[from].n > 0 || chance(30)) {
            char days[40];
            (void)snprintf(days, sizeof days, "%s-%s", weekdays[from], weekdays[to]);
            member(from == to && chance(80) ? weekdays[from] : days);
            write_hours(&schedule->weekly[from]);
        }
    }
    end('}');
}

static void write_schedules(void)
{
    for (int s = 0; s < w->n_schedules; s++) {
        const struct iso_schedule *schedule = &w->schedules[s];
        next("{");
        first = true;
        member("special_days");
        begin('[');
        for (int i = 0; i < schedule->n_special; i++) {
            next("{");
            first = true;
            member_text("group", w->groups[schedule->special[i].group].token);
            if (schedule->special[i].hours.n > 0 || chance(50)) {
                member("hours");
                write_hours(&schedule->special[i].hours);
            }
            end('}');
        }
        end(']');
        member_text("token", schedule->token);
        member("weekly");
        write_weekly(schedule);
        member_text("zone", w->zones[schedule->zone].name);
        end('}');
    }
}

static void write_levels(void)
{
    static const char *const methods[] = {"face", "card", "pin"};
    for (int l = 0; l < w->n_levels; l++) {
        const struct iso_security_level *level = &w->levels[l];
        next("{");
        first = true;
        member_text("token", level->token);
        if (level->priority != l + 1 || chance(50)) {
            member("priority");
            (void)fprintf(out, "%d", level->priority);
        }
        if (level->open || chance(30)) {
            member("open");
            (void)fputs(level->open ? "true" : "false", out);
        }
        member("recognition_groups");
        begin('[');
        for (int g = 0; g < level->n_groups; g++) {
            next("[");
            first = true;
            const uint32_t shift = draw(3);
            for (uint32_t m = 0; m < 3; m++) {
                if ((level->groups[g] >> (m + shift) % 3 & 1) != 0) {
                    next("");
                    text(methods[(m + shift) % 3]);
                }
            }
            end(']');
        }
        end(']');
        end('}');
    }
}

static void write_constraint(const struct iso_level_constraint *constraint)
{
    if (constraint->level == ISO_INDEX_NONE) {
        (void)fputs("null", out);
        return;
    }
    begin('{');
    member_text("level", w->levels[constraint->level].token);
    if (constraint->dual || chance(30)) {
        member("two_people");
        (void)fputs(constraint->dual ? "true" : "false", out);
    }
    end('}');
}

static void write_authentications(void)
{
    static const char *const states[] = {"inactive", "active", "special_inactive",
                                         "special_active"};
    for (int a = 0; a < w->n_authentication_profiles; a++) {
        const struct iso_authentication_profile *profile = &w->authentication_profiles[a];
        next("{");
        first = true;
        member("policies");
        begin('[');
        for (int p = 0; p < profile->n_policies; p++) {
            next("{");
            first = true;
            for (int s = ISO_SCHEDULE_STATES - 1; s >= 0; s--) {
                member(states[s]);
                write_constraint(&profile->policies[p].constraints[s]);
            }
            member_text("schedule", w->schedules[profile->policies[p].schedule].token);
            end('}');
        }
        end(']');
        member_text("default_level", w->levels[profile->default_level].token);
        member_text("token", profile->token);
        end('}');
    }
}

static void write_points(void)
{
    static const char *const kinds[] = {"none", "soft", "hard", "timed"};
    for (int p = 0; p < w->n_access_points; p++) {
        const struct iso_access_point *point = &w->access_points[p];
        next("{");
        first = true;
        member_text("token", point->token);
        if (!point->enabled || chance(50)) {
            member("enabled");
            (void)fputs(point->enabled ? "true" : "false", out);
        }
        if (point->from != ISO_INDEX_NONE) {
            member_text("from", w->areas[point->from].token);
        }
        if (point->to != ISO_INDEX_NONE) {
            member_text("to", w->areas[point->to].token);
        }
        member_text("authentication_profile",
                    w->authentication_profiles[point->authentication_profile].token);
        if (point->antipassback != 0 || chance(50)) {
            member_text("antipassback", kinds[point->antipassback]);
        }
        if (point->antipassback_s != 0) {
            member("antipassback_s");
            (void)fprintf(out, "%d", point->antipassback_s);
        }
        end('}');
    }
}

static void write_profiles(void)
{
    for (int p = 0; p < w->n_access_profiles; p++) {
        next("{");
        first = true;
        member_text("token", w->access_profiles[p].token);
        member("policies");
        begin('[');
        for (int i = 0; i < w->access_profiles[p].n_policies; i++) {
            const struct iso_access_policy *policy = &w->access_profiles[p].policies[i];
            next("{");
            first = true;
            member_text("schedule", w->schedules[policy->schedule].token);
            member_text("access_point", w->access_points[policy->access_point].token);
            end('}');
        }
        end(']');
        end('}');
    }
}

static void write_areas(void)
{
    for (int a = 0; a < w->n_areas; a++) {
        next("{");
        first = true;
        member_text("token", w->areas[a].token);
        end('}');
    }
}

char *document_text_write(const struct iso_policy *policy, uint16_t default_profile)
{
    w = policy;
    static const struct {
        const char *name;
        void (*write)(void);
    } arrays[] = {{"special_day_groups", write_groups},
                  {"schedules", write_schedules},
                  {"areas", write_areas},
                  {"security_levels", write_levels},
                  {"authentication_profiles", write_authentications},
                  {"access_points", write_points},
                  {"access_profiles", write_profiles}};
    char *json = NULL;
    size_t size = 0;
    out = open_memstream(&json, &size);
    assert_non_null(out);
    begin('{');
    const uint32_t shift = draw(7);
    for (uint32_t i = 0; i < 7; i++) {
        member(arrays[(i + shift) % 7].name);
        begin('[');
        arrays[(i + shift) % 7].write();
        end(']');
    }
    if (default_profile != ISO_INDEX_NONE) {
        member_text("default_profile", w->access_profiles[default_profile].token);
    }
    end('}');
    assert_int_equal(fclose(out), 0);
    return json;
}
