#include "tests/firmware/fleet/program/link_figures.h"

#include <string.h>
#include <time.h>

#include "tests/firmware/rigs/cmocka_headers.h"
#include "tests/support/programs/prometheus_text.h"

bool link_figures_say_connected(const char *text)
{
    prometheus_text_check(text);
    return prometheus_text_value(text, "isotherm_door_connected") == 1;
}

void link_figures_are_online(const char *text)
{
    const double ends_s = prometheus_text_value(text, "isotherm_door_certificate_ends_seconds");
    assert_true(ends_s > (double)time(NULL) && ends_s < (double)time(NULL) + 400.0 * 86400);
    assert_true(prometheus_text_value(text, "isotherm_door_changes_missing") == 0);
    assert_true(prometheus_text_value(text, "isotherm_door_deltas_total") +
                    prometheus_text_value(text, "isotherm_door_snapshots_total") >=
                1);
    assert_true(prometheus_text_value(
                    text, "isotherm_door_messages_refused_total{reason=\"forged\"}") == 0);
    assert_non_null(strstr(text, "\nisotherm_door_zone_sequence{zone=\""));
}

void link_figures_are_alone(const char *text)
{
    assert_false(link_figures_say_connected(text));
    assert_null(strstr(text, "deltas_total"));
}
