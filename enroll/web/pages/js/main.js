/* The pages of the web server. */

import {loadPreferredLanguage} from './base/i18n.js';
import {makeApp} from './app.js';
import {http} from './transport/http.js';

await loadPreferredLanguage();
await makeApp(http, document.getElementById('app'))();
