"""The block ELEMENTS: functions of time and elements, spelt the same in the decks of all dialects."""
