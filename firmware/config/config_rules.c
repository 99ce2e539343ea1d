/* Rules for several keys of a configuration together. */
#include <math.h>
#include <string.h>

#include "drivers/base/restart_hours.h"
#include "firmware/config/config_options.h"
#include "firmware/config/config_value.h"

/* The furthest attitude of a head that is recognised (yaw_max_rad and pitch_max_rad of
 * isotherm/extract.h), about either axis. */
static const double attitude_max_deg = 40.0;

/* A pose that holds the frontal attitude is no other pose, and one that no frame can show is only
 * waited for. */
static const char *find_pose_conflict(const struct iso_config_enroll *enroll)
{
    if (enroll->pose_within_deg >= enroll->pose_yaw_deg) {
        return "[enroll] pose_within_deg is not below pose_yaw_deg";
    }
    if (enroll->pose_within_deg >= enroll->pose_pitch_deg) {
        return "[enroll] pose_within_deg is not below pose_pitch_deg";
    }
    if (enroll->pose_yaw_deg + enroll->pose_within_deg > attitude_max_deg) {
        return "[enroll] pose_yaw_deg and pose_within_deg together are above 40 degrees";
    }
    if (enroll->pose_pitch_deg + enroll->pose_within_deg > attitude_max_deg) {
        return "[enroll] pose_pitch_deg and pose_within_deg together are above 40 degrees";
    }
    return NULL;
}

static const char *find_reader_conflict(const struct iso_config *config)
{
    const struct iso_config_reader *reader = &config->reader;
    if (*reader->osdp_port && (*reader->d0 || *reader->d1)) {
        return "[reader] osdp_port and the lines d0 and d1 exclude each other";
    }
    if (*reader->osdp_key && !*reader->osdp_port) {
        return "[reader] osdp_key needs osdp_port";
    }
    if (*reader->osdp_port && strcmp(reader->osdp_port, config->panel.port) == 0) {
        return "[reader] osdp_port is the line of [panel] port";
    }
    return NULL;
}

const char *iso__config_find_conflict(const struct iso_config *config)
{
    if (config->sensor.distance_min_mm >= config->sensor.distance_max_mm) {
        return "[sensor] distance_min_mm is not below distance_max_mm";
    }
    if (config->sensor.retry_ms > config->sensor.retry_max_ms) {
        return "[sensor] retry_ms is above retry_max_ms";
    }
    if (config->door.retry_ms > config->door.retry_max_ms) {
        return "[door] retry_ms is above retry_max_ms";
    }
    if (config->lockout.first_ms > config->lockout.longest_ms) {
        return "[lockout] first_ms is above longest_ms";
    }
    if (config->update.templates > 0 && config->update.score < iso_config_threshold(config)) {
        return "[update] score is below the threshold";
    }
    if (config->decision.agree > config->decision.max_frames) {
        return "[decision] agree is above max_frames";
    }
    if (config->motion.still_mm_s > config->motion.jump_mm_s ||
        config->motion.still_deg_s > config->motion.jump_deg_s) {
        return "[motion] still_mm_s or still_deg_s is above the speed of a jump";
    }
    if (config->login.desk && strcmp(config->door.backend, "null") != 0) {
        return "[login] desk needs [door] backend = null: a login would leave the door unwatched";
    }
    struct iso_restart_hours hours;
    if (*config->fleet.restart_hours &&
        iso_restart_hours_read(config->fleet.restart_hours, &hours) < 0) {
        return "[fleet] restart_hours is not two hours of the day, such as 1-5";
    }
    const char *conflict = find_reader_conflict(config);
    return conflict ? conflict : find_pose_conflict(&config->enroll);
}

bool iso_config_has_relay(const struct iso_config *config)
{
    const struct iso_config_options *options = &config->door.options;
    return *iso_config_option(options, "relay") || !*iso_config_option(options, "wiegand_d0");
}

static const unsigned bauds[] = {9600, 19200, 38400, 57600, 115200};

unsigned iso_config_panel_baud(const struct iso_config *config)
{
    return bauds[config->panel.baud];
}

unsigned iso_config_reader_baud(const struct iso_config *config)
{
    return bauds[config->reader.osdp_baud];
}

int iso_config_panel_card_bits(const struct iso_config *config)
{
    return config->panel.card_bits == 0 ? 26 : 34;
}

double iso_config_threshold(const struct iso_config *config)
{
    static const double of_level[] = {
        [ISO_LEVEL_CONVENIENT] = 2.0, [ISO_LEVEL_BALANCED] = 3.0, [ISO_LEVEL_STRICT] = 4.0};
    const double set = config->decision.threshold;
    return set < 0.0 || set > 0.0 ? set : of_level[config->decision.level];
}

double iso_config_threshold_among(const struct iso_config *config, size_t n_people,
                                  bool provisional)
{
    const struct iso_config_decision *decision = &config->decision;
    const bool is_set = decision->threshold < 0.0 || decision->threshold > 0.0;
    const double times = (double)n_people / (double)ISO_CONFIG_PEOPLE_AT_LEVEL;
    if (is_set || !iso_method_at(config->match.method)->calibrated) {
        return iso_config_threshold(config);
    }
    const double stricter = provisional && decision->level != ISO_LEVEL_STRICT ? 1.0 : 0.0;
    return iso_config_threshold(config) + stricter + log10(fmax(times, 1.0));
}
