"""The pilot of the second drone: flies a patrol and lands while told to."""
