/* The pages of the door. */

import {makeFrame} from './frame.js';
import {makeHub} from './hub.js';
import {accounts} from './pages/accounts.js';
import {banner} from './pages/banner.js';
import {door} from './pages/door.js';
import {enrol} from './pages/enrol.js';
import {events} from './pages/events.js';
import {health} from './pages/health.js';
import {people} from './pages/people.js';
import {policy} from './pages/policy.js';
import {settings} from './pages/settings.js';
import {update} from './pages/update.js';

const PAGES = [door, people, enrol, policy, events, health, settings, accounts, update];

export function makeApp(api, root) { return makeFrame(api, root, { all: PAGES, makeState: makeHub, banner }); }
