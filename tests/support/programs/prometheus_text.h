/* A strict reader of the text format of Prometheus, version 0.0.4, with the rules of `promtool
 * check metrics`: each family has one HELP and one TYPE before its series, which stand together;
 * counters end with _total; no series comes twice. */
#ifndef TESTS_SUPPORT_PROGRAMS_PROMETHEUS_TEXT_H
#define TESTS_SUPPORT_PROGRAMS_PROMETHEUS_TEXT_H

/* Fails the running cmocka test at the first line that breaks a rule. */
void prometheus_text_check(const char *text);

/* The value of a series such as "up{job=\"a\"}". Fails the test if there is none. */
double prometheus_text_value(const char *text, const char *series);

#endif
