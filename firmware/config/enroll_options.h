/* Conversion of the configuration to the requirements of an enrolment. */
#ifndef ISO_FIRMWARE_CONFIG_ENROLL_OPTIONS_H
#define ISO_FIRMWARE_CONFIG_ENROLL_OPTIONS_H

#include "firmware/config/config.h"
#include "firmware/recognise/enroll_gate.h"

/* The requirements of a configuration for the frontal pose. */
struct iso_enroll_gate iso_enroll_gate_of(const struct iso_config_enroll *config);

#endif
